#include "cli/support/reviewed_options.hpp"

#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "setup/files/drive_file.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"

namespace palpa::test {

namespace {

using Idles = std::vector<IdleOptions>;

template <typename Item>
std::vector<Item> joined(const std::vector<std::vector<Item>>& lists) {
  std::vector<Item> all;
  for (const auto& list : lists)
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// The options of a GPU: on a line that uses none, and in a command that has none.
const Idles no_gpu{{"OPTION: --backend cpu uses no GPU", {"--gpu 0", "--validation core"}}},
    no_gpu_at_all{{"has no option 'OPTION'", {"--gpu 0", "--validation core"}}};
const Idles parts{{"OPTION goes with --surface parts", {"--parts 3", "--internal-faces keep"}}};
const Idles felt{{"OPTION goes with", {"--spot 4mm"}},
                 {"OPTION goes with --tune", {"--tune-shortest 1ms", "--tune-longest 2ms"}},
                 {"goes with --tune", {"--tune-shortest 1ms --tune-longest 2ms"}}};
/// Options of air and of boards, where nothing sounds.
const std::vector<std::string> sound{"--amplitude uniform", "--solver greedy",  "--constraint clamp",
                                     "--directivity omni",  "--temperature 25", "--sound-speed 350m/s",
                                     "--frequency 41kHz"};

/// Options from skin to foci, and of drives. tests/python/test_every_option.py tries their effects.
const std::string touched =
                      " --scene --gltf-scene --delta --finger-gap --min-points --cluster --surface --spacing --method "
                      "--stride --dwell --modulation --modulation-frequency --tune --rig --layout ",
                  driven =
                      " --amplitude --constraint --solver --pressure --directivity --temperature --sound-speed "
                      "--frequency ",
                  of_drive_and_field = driven + "--layout --focus --null --spread --draws ",
                  in_air = " --humidity --air-pressure --no-absorption ";

ReviewedLine of_touch() {
  const std::string points = " --points ROOT/assets/finger.ply --penetration 3mm --backend cpu";
  return {.line = "touch --scene ROOT/assets/cube.glb" + points,
          .idle = joined<IdleOptions>({no_gpu,
                                       parts,
                                       felt,
                                       {{"goes with --layout", sound},
                                        {"goes with --layout", {"--pressure 1kPa", "--audible"}},
                                        {"OPTION goes with --audible", {"--steps off", "--wav none/x.wav"}},
                                        {"--wav-scale goes with --wav", {"--wav-scale 60"}},
                                        {"go with --depth", {"--camera x.toml", "--rig x.toml"}},
                                        {"--finger-width goes with --depth", {"--finger-width 10mm"}}}}),
          .untried = touched + driven + "--points --depth --foci --penetration --spectrum --spot --audible --steps",
          // On a ridge, where a cross-section is not round.
          .tried_as = "touch --scene ROOT/assets/prism.glb --json OUT/touch.json" + points,
          .effective = {{"", {"--csv OUT/contacts.csv"}},
                        {"--layout openmpd --audible", {"--wav OUT/touch.wav"}},
                        {"--layout openmpd --audible --wav OUT/touch.wav", {"--wav-scale 60"}}}};
}

ReviewedLine of_run() {
  return {
      .line = "run --scene ROOT/assets/cube.glb --backend cpu --frames 1",
      .idle = joined<IdleOptions>(
          {no_gpu,
           parts,
           {{"--event-move goes with --events", {"--event-move 1mm"}},
            {"--noise-free goes with", {"--noise-free --source recording:none"}},
            {"--spot goes with --tune", {"--spot 4mm"}},
            {"--overwrite goes with --record", {"--overwrite"}},
            {"--predict-latency goes with --predict auto", {"--predict off --predict-latency 20ms"}},
            {"give --predict-latency", {"--every-frame --predict auto"}},
            {"--finger goes with --transfer finger", {"--finger tip.ply"}},
            {"--board-files goes with a link to boards", {"--board-files /"}},
            {"--steps goes with a link to boards", {"--steps off"}}}}),
      // A run measures itself, so that no two of them have the same results. These are tried with export.
      .untried = touched + driven +
                 "--transfer --null --source --frames --hold --ceiling --ramp --events --finger-width --axes "
                 "--smoothing --hysteresis --predict --predict-latency --foci --link --every-frame --record --stats "
                 "--keep-boards --osc --reload"};
}

std::vector<ReviewedLine> of_export() {
  const std::string cube = "export --scene ROOT/assets/cube.glb --backend cpu",
                    recorded = cube + " --source recording:ROOT/assets/depth/take";
  const Idles of_sound{{"OPTION goes with --drives", sound}},
      of_order{{"OPTION goes with --drives",
                {"--stride 7", "--modulation amplitude-sine", "--modulation-frequency 100Hz", "--tune"}}},
      of_foci{{"OPTION goes with --foci",
               {"--foci-count 8", "--spacing arc", "--method ellipse", "--axes covariance", "--smoothing none",
                "--predict-latency 20ms", "--ceiling 0.5"}},
              {"OPTION goes with --drives", {"--layout openmpd", "--rig ROOT/assets/rigs/paper.toml"}}};
  return {
      {.line = cube + " --frames 1 --foci -",
       .idle = joined<IdleOptions>({no_gpu,
                                    parts,
                                    of_sound,
                                    {{"--event-move goes with --events", {"--event-move 1mm"}},
                                     {"--noise-free goes with", {"--noise-free --source recording:none"}},
                                     {"--spot goes with --tune", {"--spot 4mm"}},
                                     {"--hysteresis goes with", {"--hysteresis on --finger-width 0"}},
                                     {"has no effect with --played", {"--played played.json"}},
                                     {"give --predict-latency", {"--predict auto"}}}}),
       // Only fingers that flicker show hysteresis: see test_touch_known. The finger of the recording rests, so that
       // nothing of it is predicted. The boards are out of the cube's reach; tests of surroundings try --keep-boards.
       .untried = touched + driven +
                  "--source --finger-width --hysteresis --predict --predict-latency --keep-boards --foci-count --hold "
                  "--ceiling --ramp --event-move --axes --smoothing --frames"},
      {.line = recorded + " --foci -",
       .tried_as = recorded + " --json OUT/all.json --events OUT/events.jsonl",
       .effective = {{"", {"--foci OUT/foci.csv", "--drives OUT/drives.bin", "--pressure 500Pa", "--dwell 2ms"}},
                     {"--pressure 90kPa", {"--layout sonicsurface"}},
                     {"--foci OUT/foci.csv", {"--spacing arc"}},
                     {"--foci OUT/foci.json", {"--stride 7"}}}},
      {.line = recorded + " --events -",
       .idle = joined<IdleOptions>({of_sound, of_order, of_foci}),
       .tried_as = recorded + " --json OUT/all.json --foci OUT/foci.csv",
       .effective = {{"", {"--events OUT/events.jsonl"}}}},
      {.line = recorded + " --foci SCRATCH/foci.csv --events -", .idle = joined<IdleOptions>({of_sound, of_order})},
      {.line = "export --played SCRATCH/played.json --drives -",
       .idle = {{"has no effect with --played",
                 {"--scene ROOT/assets/cube.glb", "--source synthetic", "--frames 1", "--foci -", "--foci-count 8",
                  "--dwell 2ms", "--pressure 1kPa", "--events -", "--gpu 0"}},
                {"OPTION has no effect with --played",
                 {"--gltf-scene 0",
                  "--noise-free",
                  "--keep-boards",
                  "--event-move 1mm",
                  "--surface parts",
                  "--parts 3",
                  "--delta 1mm",
                  "--finger-gap 3mm",
                  "--internal-faces keep",
                  "--min-points 4",
                  "--finger-width 0",
                  "--cluster inside",
                  "--spacing arc",
                  "--stride 3",
                  "--method ellipse",
                  "--tune",
                  "--spot 3mm",
                  "--modulation amplitude-sine",
                  "--axes covariance",
                  "--smoothing none",
                  "--modulation-frequency 100Hz",
                  "--predict off",
                  "--hysteresis off",
                  "--predict-latency 20ms",
                  "--seed 3",
                  "--validation core"}}},
       .tried_as = "export --played SCRATCH/played.json --drives OUT/drives.bin",
       .effective = {{"", {"--rig SCRATCH/rig.toml"}},
                     {"--layout openmpd",
                      {"--layout autd3", "--hold 20ms", "--ceiling 0.5", "--ramp 5ms", "--constraint clamp",
                       "--solver greedy", "--temperature 25", "--sound-speed 350m/s"}},
                     {"--layout openmpd --constraint normalise", {"--amplitude distance"}},
                     {"--layout SCRATCH/bare.toml", {"--frequency 41kHz"}},
                     {"--layout openmpd --solver greedy", {"--directivity omni"}}}}};
}

std::vector<ReviewedLine> of_calibrate() {
  const std::string rig = "--rig ROOT/tests/cli/support/small_rig.toml";
  const Idles gpu_of_nudge{{"go with --nudge", {"--gpu 0", "--validation core"}}},
      keys{{"--keys goes with --nudge", {"--keys enter"}}};
  return {
      {.line = "calibrate --layout openmpd",
       .idle = joined<IdleOptions>(
           {gpu_of_nudge,
            keys,
            {{"OPTION goes with --nudge",
              {"--scene ROOT/assets/cube.glb", "--link foci:udp:127.0.0.1:9", "--board-files /", "--hold 50ms",
               "--ceiling 0.5", "--ramp 10ms"}},
             {"goes with --nudge", {"--temperature 25", "--sound-speed 350m/s", "--frequency 41kHz"}}}}),
       .untried = "--target --turn --source --frames --out --layout --rig --background --nudge --by-touch --noise-free "
                  "--at"},
      {.line = "calibrate --layout openmpd --background",
       .idle = joined<IdleOptions>({gpu_of_nudge,
                                    keys,
                                    {{"exclude each other", {"--at 0,0,1mm", "--turn 90", "--nudge", "--by-touch"}},
                                     {"--out needs --source", {"--out x.toml"}}}}),
       .tried_as = "calibrate --background " + rig + " --frames 10 --json OUT/learned.json",
       .effective = {{"", {"--noise-free"}}}},
      {.line = "calibrate --layout openmpd --target none/t.stl",
       .idle = joined<IdleOptions>({gpu_of_nudge,
                                    keys,
                                    {{"exclude each other",
                                      {"--source synthetic", "--frames 3", "--noise-free", "--out x.toml", "--nudge",
                                       "--by-touch", "--background"}},
                                     {"--target only writes the model", {"--json -"}},
                                     {"a printer's .stl lies as it is printed", {"--at 0,0,1mm", "--turn 90"}}}}),
       .tried_as = "calibrate --target OUT/target.glb --layout openmpd",
       .effective = {{"", {"--at 5mm,0,0", "--turn 90", "--layout sonicsurface", "--target OUT/target.stl"}}}}};
}

std::vector<ReviewedLine> of_drive() {
  const std::string line = "drive --layout openmpd --focus 0,0,10cm --backend cpu";
  return {
      {.line = line,
       .idle = joined<IdleOptions>({no_gpu,
                                    {{"OPTION goes with --touch", {"--slot 1", "--rig x.toml"}},
                                     {"OPTION goes with --transfer finger", {"--mesh SCRATCH/above.ply", "--force"}},
                                     {"--draws goes with --spread", {"--draws 50"}}}}),
       .untried = of_drive_and_field + "--touch --pattern --transfer",
       .effective = {{"", {"--csv OUT/drive.csv"}}}},
      {.line = "drive --layout openmpd --touch x.json --backend cpu",
       .idle = {{"exclude each other", {"--focus 0,0,10cm"}}}},
      {.line = "drive --layout paper --pattern hoshi --backend cpu",
       .idle = {{"--focus and --pattern exclude each other", {"--focus 0,0,1cm"}},
                {"--null and --pattern exclude each other", {"--null 2cm,0,0"}},
                {"--pattern and --touch exclude each other", {"--touch x.json"}}}}};
}

std::vector<ReviewedLine> of_play() {
  const std::string line = "play heartbeat --duration 50ms --layout openmpd --csv -";
  return {{.line = line,
           .idle = joined<IdleOptions>({no_gpu_at_all,
                                        {{"OPTION goes with --on", {"--upright", "--source joints:x", "--hold 50ms"}},
                                         {"OPTION goes with --scene", {"--gltf-scene 0", "--allow-outside"}},
                                         {"--scene goes with --source", {"--scene ROOT/assets/cube.glb"}},
                                         {"--on needs --source", {"--on palm"}},
                                         {"--board-files goes with a link to boards", {"--board-files /"}},
                                         {"--steps goes with a link to boards that take steps", {"--steps off"}}}}),
           .untried = "--link --osc --rig --ceiling --ramp --amplitude --temperature --sound-speed --frequency "
                      "--layout --png",
           .tried_as = "play heartbeat --duration 50ms --csv OUT/slots.csv --json OUT/play.json",
           .effective = {{"",
                          {"--param rate=120", "--speed 2", "--dwell 0.5ms", "--duration 60ms", "--at 0,0,10cm",
                           "--csv OUT/other.csv"}}}},
          {.line = "play circle --on palm --source joints:none",
           .idle = {{"--at and --on exclude each other", {"--at 0,0,10cm"}},
                    {"--csv and --png know no hand", {"--csv -", "--png x.png"}},
                    {"--scene goes with --on finger", {"--scene ROOT/assets/cube.glb"}}}}};
}

const IdleOptions of_plane{"goes with --plane", {"--centre 0,0,0", "--size 6mm,6mm", "--pixels 8,8"}};

ReviewedLine of_field() {
  const std::string line = "field --layout openmpd --focus 0,0,10cm --line 0,0,1cm 0,0,2cm --backend cpu";
  return {.line = line,
          .idle = joined<IdleOptions>(
              {no_gpu,
               {of_plane,
                {"--draws goes with --spread", {"--draws 50"}},
                {"exclude each other", {"--humidity 20 --no-absorption", "--air-pressure 90kPa --no-absorption"}}}}),
          .untried = of_drive_and_field + in_air + "--drive --plane --points --line --samples",
          .effective = {{"", {"--csv OUT/field.csv", "--vtu OUT/field.vtu", "--png OUT/field.png"}}}};
}

std::vector<ReviewedLine> of_scatter() {
  const std::string line = "scatter --mesh SCRATCH/pebble.ply --plane-wave 0,0,1";
  return {{.line = line,
           .idle = joined<IdleOptions>({no_gpu_at_all,
                                        {of_plane,
                                         {"--samples goes with --line", {"--samples 9"}},
                                         {"go together", {"--layout openmpd"}},
                                         {"exclude each other", {"--drive x.csv"}},
                                         {"OPTION goes with --drive", {"--directivity omni", "--absorption"}},
                                         {"--humidity goes with --absorption", {"--humidity 20"}}}}),
           .untried = "--mesh --force --point-source --plane --plane-wave --temperature --sound-speed --frequency" +
                      in_air + "--absorption --directivity",
           .tried_as = line + " --json OUT/body.json --csv OUT/faces.csv",
           .effective = {{"", {"--line 0,0,2mm 0,0,3mm", "--points SCRATCH/raised.ply", "--csv OUT/other.csv"}},
                         {"--line 0,0,2mm 0,0,3mm", {"--samples 5"}}}},
          {.line = "scatter --mesh SCRATCH/raised.ply --layout openmpd --drive SCRATCH/drive.csv",
           .idle = {{"--humidity goes with --absorption", {"--humidity 20"}}}}};
}

std::vector<ReviewedLine> of_simulate() {
  const std::string line =
      "simulate --scene ROOT/assets/cube.glb --finger SCRATCH/tip.ply --penetration 1mm --backend cpu";
  return {{.line = line,
           .idle = joined<IdleOptions>({no_gpu,
                                        felt,
                                        parts,
                                        {{"OPTION goes with --skin cameras", {"--noise-free", "--finger-width 10mm"}},
                                         {"--draws goes with --spread", {"--draws 50"}},
                                         {"exclude each other", {"--humidity 20 --no-absorption"}}}}),
           .untried = touched + driven + in_air +
                      "--finger --skin --figure6 --force --spread --foci --spectrum --penetration --transfer",
           .tried_as = line + " --layout openmpd --json OUT/felt.json",
           .effective = {{"", {"--csv OUT/faces.csv", "--vtu OUT/faces.vtu", "--png OUT/finger.png"}}}},
          {.line = "simulate --figure6 --backend cpu",
           .idle = {{"exclude each other",
                     {"--scene ROOT/assets/cube.glb", "--gltf-scene 0", "--csv x.csv", "--vtu x.vtu",
                      "--method ellipse", "--spread phase=0.1", "--surface parts", "--parts 3"}}}}};
}

ReviewedLine of_afferents() {
  return {
      .line =
          "afferents --scene ROOT/assets/cube.glb --finger SCRATCH/tip.ply --penetration 1mm --layout openmpd "
          "--duration 50ms --json OUT/a.json",
      .idle = joined<IdleOptions>({no_gpu_at_all,
                                   {{"exclude each other", {"--linear --crest 16"}},
                                    {"--stride: a single focus has no order", {"--stride 3 --method single-focus"}}}}),
      .untried = "--scene --finger --delta",
      .effective = {
          {"",
           {"--penetration 0.8mm", "--x 1mm", "--z 1mm", "--yaw 30", "--method ellipse", "--foci 6", "--stride 1",
            "--dwell 2ms", "--layout sonicsurface", "--crest 50", "--linear", "--duration 60ms", "--wave-speed 4",
            "--bin 10ms", "--csv OUT/sites.csv", "--times OUT/times.csv", "--png OUT/spikes.png"}},
          {"--method single-focus", {"--modulation-frequency 100"}}}};
}

/// A command of studies, which use no GPU.
ReviewedLine of_study(const std::string& line, const std::string& untried, const Idles& more = {}) {
  return {.line = "study " + line, .idle = joined<IdleOptions>({no_gpu_at_all, more}), .untried = untried};
}

std::vector<ReviewedLine> of_studies() {
  const std::string plan = "ROOT/assets/studies/paper.toml";
  return {of_study("analyse none", "--html --csv --script"),
          of_study("compare paper", "--html --csv --script"),
          of_study("level " + plan, "", {{"--override has no effect", {"--override x"}}}),
          of_study("plan " + plan, "--participant --csv", {{"--seed belongs to the plan", {"--seed 1"}}}),
          of_study("rehearse " + plan + " --participant 1 --out none/x", "--participant --out --accuracy"),
          {.line = "study run " + plan + " --participant 1 --out none/x --rehearse 1 --size 640x480",
           .idle = {{"--monitor and --size exclude each other", {"--monitor 1"}},
                    {"--eyes-apart goes with --stereo", {"--eyes-apart 60mm"}},
                    {"go with --stereo columns or rows",
                     {"--barrier-pitch 1mm", "--barrier-gap 1mm", "--barrier-phase 0.5"}},
                    {"has no option 'OPTION'", {"--osc 9000", "--reload"}},
                    {"--gpu", {"--backend cpu --gpu 0"}},
                    {"--validation", {"--backend cpu --validation core"}}},
           .untried =
               "--participant --out --source --link --rig --board-files --hold --size --stereo --override --rehearse "
               "--gpu --validation"},
          of_study("simulate " + plan, "--finger --beside --html --csv --prediction"),
          of_study("withdraw 1 --out none", "--out"),
          of_study("power",
                   "--html --csv --baseline --accuracy --spread --correlation --trials --alpha --power --people "
                   "--studies")};
}

std::vector<ReviewedLine> of_emulate() {
  return {
      {.line = "emulate openmpd --serial IDLE1",
       .idle = joined<IdleOptions>(
           {no_gpu_at_all,
            {{"OPTION goes with autd3 and autd3-udp, not with openmpd", {"--port 0"}},
             {"OPTION goes with autd3-udp, not with openmpd", {"--protocol 3", "--processing 1ms", "--fault lose=1%"}},
             {"OPTION goes with sonicsurface, not with openmpd", {"--tactile"}},
             {"OPTION goes with --view", {"--layout openmpd", "--board-files /"}}}}),
       .untried = "--serial --uart --trace --view"},
      {.line = "emulate autd3 --port 0",
       .idle = {{"OPTION goes with openmpd, not with autd3", {"--uart", "--serial A"}},
                {"OPTION goes with sonicsurface, not with autd3", {"--tactile"}},
                {"OPTION goes with autd3-udp, not with autd3", {"--protocol 3", "--processing 1ms", "--fault lose=1%"}},
                {"OPTION goes with openmpd and sonicsurface, not with autd3", {"--board-files /"}}},
       .untried = "--port --layout"},
      {.line = "emulate autd3-udp --port 0",
       .idle = {{"OPTION goes with openmpd, not with autd3-udp", {"--uart", "--serial A"}},
                {"OPTION goes with sonicsurface, not with autd3-udp", {"--tactile"}},
                {"OPTION goes with openmpd and sonicsurface, not with autd3-udp", {"--board-files /"}}},
       .untried = "--port --layout --protocol --processing --fault"},
      {.line = "emulate sonicsurface",
       .idle = {{"OPTION goes with openmpd, not with sonicsurface", {"--uart", "--serial A"}},
                {"OPTION goes with autd3 and autd3-udp, not with sonicsurface", {"--port 1"}},
                {"OPTION goes with autd3-udp, not with sonicsurface",
                 {"--protocol 3", "--processing 1ms", "--fault lose=1%"}},
                {"OPTION goes with --view", {"--board-files /"}}},
       .untried = "--tactile --layout"}};
}

void write_inputs(const std::string& scratch) {
  const auto write = [&](const std::string& name, const geometry::Mesh& mesh, const Vec3& by) {
    const geometry::Mesh moved = transformed(mesh, [&](const Vec3& p) { return p + by; });
    geometry::write_ply(scratch + "/" + name, moved.positions, moved.triangles);
  };
  write("above.ply", geometry::icosphere(2e-3, 3), {0, 0, 0.1});
  write("pebble.ply", geometry::icosphere(1e-3, 3), {0, 0, 0});
  write("raised.ply", geometry::icosphere(1e-3, 3), {0, 0, 0.05});
  write("tip.ply", sphere(2e-3, 8, 12), {0, 2e-3, 0});
  const array::Layout layout = array::load_layout("openmpd");
  write_text(scratch + "/drive.csv", setup::drive_csv(layout, array::Drive(layout.transducers.size(), {1, 0})));
  write_text(scratch + "/bare.toml",
             "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n"
             "[[transducer]]\nposition_m = [0.02, 0, 0]\naxis = [0, 0, 1]\n");
  write_text(scratch + "/rig.toml", "[array]\nlayout = \"openmpd\"\n");
  write_text(scratch + "/played.json",
             R"({"slot_s": 0.0015, "frames": [{"slot": 3, "time_s": 1, "fingers": [{"id": 0, "solid": "",)"
             R"("foci_m": [[0, 0.15, 0], [0.01, 0.15, 0]], "order": [[1, 0]], "dwell_s": 0.0015,)"
             R"("modulation_hz": 0, "gain": 1}]}]})");
}

}  // namespace

std::vector<ReviewedLine> reviewed_lines(const std::string& scratch) {
  write_inputs(scratch);
  return joined<ReviewedLine>(
      {{{.line = "doctor",
         .idle = joined<IdleOptions>({{{"--source goes with --write-rig", {"--source bag:x"}},
                                       {"--layout goes with --rig", {"--layout openmpd"}},
                                       {"--serial goes with --write-eeprom", {"--serial LAB1"}},
                                       {"--write-eeprom goes with --serial", {"--write-eeprom none/board.conf"}}},
                                      no_gpu_at_all}),
         .untried = "--write-rig --rig --write-eeprom"},
        of_touch(),
        of_run(),
        {.line = "link test --link null --layout openmpd --last 0 --each 1ms --rest 0",
         .idle = joined<IdleOptions>({{{"--board-files goes with a link to boards", {"--board-files /"}},
                                       {"OPTION sounds whole boards at full amplitude", {"--compare 0,0,10cm"}}},
                                      no_gpu_at_all}),
         .untried = "--link --layout --first --last --each --rest --dwell --amplitude"},
        of_field(),
        of_afferents(),
        {.line = "decompose --scene ROOT/assets/cube.glb --out none/x.glb",
         .idle = no_gpu_at_all,
         .untried = "--scene --gltf-scene --out --parts --resolution --error"},
        {.line = "bench --suite array",
         .idle = {{"--scene goes with --suite surface", {"--scene ROOT/assets/cube.glb"}},
                  {"bench measures the GPU", {"--backend cpu"}}},
         .untried = "--suite --runs --csv --gpu --validation"}},
       of_studies(),
       of_export(),
       of_play(),
       of_calibrate(),
       of_drive(),
       of_scatter(),
       of_simulate(),
       of_emulate()});
}

}  // namespace palpa::test
