#include "cli/support/reviewed_options.hpp"

#include <sstream>

#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "cli/support/every_command.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "setup/drive_file.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

std::vector<IdleOption> no_gpu_at_all() {
  return {{{"--gpu", "0"}, "has no option '--gpu'"}, {{"--validation", "core"}, "has no option '--validation'"}};
}

namespace {

using Effects = std::vector<EffectiveOption>;
using Idles = std::vector<IdleOption>;

std::string asset(const std::string& name) {
  return source_file("assets/" + name).string();
}

template <typename Option>
std::vector<Option> joined(const std::vector<std::vector<Option>>& lists) {
  std::vector<Option> all;
  for (const auto& list : lists)
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// All of them beside the same words.
Effects beside(const std::vector<std::string>& words, Effects options) {
  for (EffectiveOption& option : options)
    option.beside = with(option.beside, words);
  return options;
}

std::string ply_in(const std::string& folder, const std::string& name, const geometry::Mesh& mesh) {
  const std::string file = folder + "/" + name;
  geometry::write_ply(file, mesh.positions, mesh.triangles);
  return file;
}

const Idles no_gpu{{{"--gpu", "0"}, "--gpu: --backend cpu uses no GPU"},
                   {{"--validation", "core"}, "--validation: --backend cpu uses no GPU"}};
const Idles gpu_of_nudge{{{"--gpu", "0"}, "go with --nudge"}, {{"--validation", "core"}, "go with --nudge"}};
const Idles parts{{{"--parts", "3"}, "--parts goes with --surface parts"},
                  {{"--internal-faces", "keep"}, "--internal-faces goes with --surface parts"}};
const Idles felt{{{"--spot", "4mm"}, "--spot goes with"},
                 {{"--tune-shortest", "1ms"}, "--tune-shortest goes with --tune"},
                 {{"--tune-longest", "2ms"}, "--tune-longest goes with --tune"},
                 {{"--tune-shortest", "1ms", "--tune-longest", "2ms"}, "goes with --tune"}};

/// Options from skin to foci.
const Effects touched{{{"--delta", "1mm"}}, {{"--finger-gap", "0.1mm"}}, {{"--min-points", "100000"}}};
const Effects placed{{{"--spacing", "arc"}}, {{"--method", "ellipse"}}};
const Effects scheduled{{{"--stride", "7"}},
                        {{"--dwell", "2ms"}},
                        {{"--modulation", "amplitude-sine"}, {"--method", "single-focus"}},
                        {{"--modulation-frequency", "100Hz"}, {"--method", "single-focus"}}};
/// Options of drives. Foci have to sound together for a solver to make a difference.
const Effects driven{{{"--amplitude", "uniform"}}, {{"--constraint", "uniform"}}, {{"--pressure", "500Pa"}},
                     {{"--temperature", "30"}},    {{"--sound-speed", "350m/s"}}, {{"--frequency", "41kHz"}}};
const Effects solved{{{"--solver", "greedy"}, {"--method", "multi-focus"}}};
const Effects heard{{{"--directivity", "omni"}}};
const Effects varied{{{"--spread", "phase=0.1"}}, {{"--draws", "30"}, {"--spread", "phase=0.1"}}};
const Effects sounding = joined<EffectiveOption>({driven, heard, varied});

ReviewedLine of_touch() {
  const std::vector<std::string> line{"touch",         "--scene", asset("cube.glb"), "--points", asset("finger.ply"),
                                      "--penetration", "3mm",     "--backend",       "cpu"};
  return {.line = line,
          .idle = joined<IdleOption>({no_gpu,
                                      parts,
                                      felt,
                                      {{{"--camera", "x.toml"}, "go with --depth"},
                                       {{"--rig", "x.toml"}, "go with --depth"},
                                       {{"--finger-width", "10mm"}, "--finger-width goes with --depth"},
                                       {{"--amplitude", "uniform"}, "goes with --layout"},
                                       {{"--solver", "greedy"}, "goes with --layout"},
                                       {{"--constraint", "clamp"}, "goes with --layout"},
                                       {{"--pressure", "1kPa"}, "goes with --layout"},
                                       {{"--directivity", "omni"}, "goes with --layout"},
                                       {{"--temperature", "25"}, "goes with --layout"},
                                       {{"--sound-speed", "350m/s"}, "goes with --layout"},
                                       {{"--frequency", "41kHz"}, "goes with --layout"}}}),
          .untried = "--scene --gltf-scene --points --depth --surface --cluster",
          // On a ridge, where a cross-section is not round.
          .tried_as = with(without(line, "--scene"), {"--scene", asset("prism.glb"), "--json", "OUT/touch.json"}),
          .effective = joined<EffectiveOption>({touched,
                                                placed,
                                                scheduled,
                                                beside({"--layout", "openmpd"}, driven),
                                                beside({"--layout", "openmpd"}, solved),
                                                beside({"--layout", "openmpd"}, heard),
                                                {{{"--penetration", "2mm"}},
                                                 {{"--csv", "OUT/contacts.csv"}},
                                                 {{"--foci", "8"}},
                                                 {{"--tune"}},
                                                 {{"--spectrum"}},
                                                 {{"--layout", "openmpd"}},
                                                 {{"--spot", "5mm"}, {"--spectrum"}}}})};
}

ReviewedLine of_run() {
  return {
      .line = {"run", "--scene", asset("cube.glb"), "--backend", "cpu", "--frames", "1"},
      .idle = joined<IdleOption>(
          {no_gpu,
           parts,
           {{{"--event-move", "1mm"}, "--event-move goes with --events"},
            {{"--noise-free", "--source", "recording:none"}, "--noise-free goes with"},
            {{"--spot", "4mm"}, "--spot goes with --tune"},
            {{"--overwrite"}, "--overwrite goes with --record"},
            {{"--predict", "off", "--predict-latency", "20ms"}, "--predict-latency goes with --predict auto"},
            {{"--every-frame", "--predict", "auto"}, "give --predict-latency"},
            {{"--finger", "tip.ply"}, "--finger goes with --transfer finger"},
            {{"--board-files", "/"}, "--board-files goes with a link to boards"}}}),
      // A run measures itself, so that no two of them have the same results. These are tried with export.
      .untried =
          "--delta --finger-gap --min-points --cluster --spacing --stride --dwell --method --modulation "
          "--modulation-frequency --tune --amplitude --solver --constraint --pressure --directivity "
          "--transfer --null --temperature --sound-speed --frequency --scene --gltf-scene --source --frames --hold "
          "--ceiling --ramp --events --surface --rig --layout --finger-width --axes --smoothing --hysteresis --predict "
          "--predict-latency --foci --link --every-frame --record --stats --keep-boards"};
}

std::vector<ReviewedLine> of_export(const std::string& scratch) {
  const std::vector<std::string> synthetic{"export",   "--scene", asset("cube.glb"), "--backend", "cpu",
                                           "--frames", "1",       "--foci",          "-"};
  const std::vector<std::string> recorded{
      "export", "--scene", asset("cube.glb"), "--source", "recording:" + asset("depth/take"), "--backend", "cpu"};
  const Idles of_sound{{{"--amplitude", "uniform"}, "--amplitude goes with --drives"},
                       {{"--solver", "greedy"}, "--solver goes with --drives"},
                       {{"--constraint", "clamp"}, "--constraint goes with --drives"},
                       {{"--directivity", "omni"}, "--directivity goes with --drives"},
                       {{"--temperature", "25"}, "--temperature goes with --drives"},
                       {{"--sound-speed", "350m/s"}, "--sound-speed goes with --drives"},
                       {{"--frequency", "41kHz"}, "--frequency goes with --drives"}};
  const Idles of_order{{{"--stride", "7"}, "--stride goes with --drives"},
                       {{"--modulation", "amplitude-sine"}, "--modulation goes with --drives"},
                       {{"--modulation-frequency", "100Hz"}, "--modulation-frequency goes with --drives"},
                       {{"--tune"}, "--tune goes with --drives"}};
  const Idles of_foci{{{"--foci-count", "8"}, "--foci-count goes with --foci"},
                      {{"--spacing", "arc"}, "--spacing goes with --foci"},
                      {{"--method", "ellipse"}, "--method goes with --foci"},
                      {{"--axes", "covariance"}, "--axes goes with --foci"},
                      {{"--smoothing", "none"}, "--smoothing goes with --foci"},
                      {{"--predict-latency", "20ms"}, "--predict-latency goes with --foci"},
                      {{"--ceiling", "0.5"}, "--ceiling goes with --foci"},
                      {{"--layout", "openmpd"}, "--layout goes with --drives"},
                      {{"--rig", asset("rigs/paper.toml")}, "--rig goes with --drives"}};
  return {
      {.line = synthetic,
       .idle = joined<IdleOption>({no_gpu,
                                   parts,
                                   of_sound,
                                   {{{"--event-move", "1mm"}, "--event-move goes with --events"},
                                    {{"--noise-free", "--source", "recording:none"}, "--noise-free goes with"},
                                    {{"--spot", "4mm"}, "--spot goes with --tune"},
                                    {{"--hysteresis", "on", "--finger-width", "0"}, "--hysteresis goes with"},
                                    {{"--played", "played.json"}, "has no effect with --played"},
                                    {{"--predict", "auto"}, "give --predict-latency"}}}),
       // Only fingers that flicker show hysteresis: see test_touch_known. The finger of the recording rests, so that
       // nothing of it is predicted. The boards are out of the cube's reach; tests of surroundings try --keep-boards.
       .untried =
           "--scene --gltf-scene --source --surface --cluster --finger-width --rig --tune --hysteresis --predict "
           "--predict-latency --keep-boards",
       .tried_as = with(recorded, {"--layout", "openmpd", "--foci", "OUT/foci.json", "--events", "OUT/events.jsonl",
                                   "--drives", "OUT/drives.bin", "--json", "OUT/all.json"}),
       .effective = joined<EffectiveOption>({touched,
                                             placed,
                                             scheduled,
                                             driven,
                                             solved,
                                             beside({"--method", "multi-focus"}, heard),
                                             {{{"--foci-count", "8"}},
                                              {{"--hold", "20ms"}},
                                              {{"--ceiling", "0.5"}},
                                              {{"--ramp", "10ms"}},
                                              {{"--event-move", "0"}},
                                              {{"--axes", "covariance"}},
                                              {{"--smoothing", "none"}},
                                              {{"--layout", "sonicsurface"}},
                                              {{"--frames", "3"}}}})},
      {.line = with(recorded, {"--foci", "-"}),
       .tried_as = with(recorded, {"--json", "OUT/all.json", "--events", "OUT/events.jsonl"}),
       .effective = {{{"--foci", "OUT/foci.csv"}},
                     {{"--drives", "OUT/drives.bin"}},
                     {{"--pressure", "500Pa"}},
                     {{"--dwell", "2ms"}},
                     {{"--layout", "sonicsurface"}, {"--pressure", "90kPa"}},
                     {{"--spacing", "arc"}, {"--foci", "OUT/foci.csv"}},
                     {{"--stride", "7"}, {"--foci", "OUT/foci.json"}}}},
      {.line = with(recorded, {"--events", "-"}),
       .idle = joined<IdleOption>({of_sound, of_order, of_foci}),
       .tried_as = with(recorded, {"--json", "OUT/all.json", "--foci", "OUT/foci.csv"}),
       .effective = {{{"--events", "OUT/events.jsonl"}}}},
      {.line = with(recorded, {"--foci", scratch + "/foci.csv", "--events", "-"}),
       .idle = joined<IdleOption>({of_sound, of_order})},
  };
}

ReviewedLine of_link() {
  return {
      .line = {"link", "test", "--link", "null", "--layout", "openmpd", "--last", "0", "--each", "1ms", "--rest", "0"},
      .idle =
          joined<IdleOption>({{{{"--board-files", "/"}, "--board-files goes with a link to boards"}}, no_gpu_at_all()}),
      .untried = "--link --layout --first --last --each --rest --dwell --amplitude"};
}

std::vector<ReviewedLine> of_calibrate() {
  const std::string rig = source_file("tests/cli/support/small_rig.toml").string();
  return {{.line = {"calibrate", "--layout", "openmpd"},
           .idle = joined<IdleOption>({gpu_of_nudge,
                                       {{{"--scene", asset("cube.glb")}, "--scene goes with --nudge"},
                                        {{"--link", "foci:udp:127.0.0.1:9"}, "--link goes with --nudge"},
                                        {{"--board-files", "/"}, "--board-files goes with --nudge"},
                                        {{"--keys", "enter"}, "--keys goes with --nudge"},
                                        {{"--hold", "50ms"}, "--hold goes with --nudge"},
                                        {{"--ceiling", "0.5"}, "--ceiling goes with --nudge"},
                                        {{"--ramp", "10ms"}, "--ramp goes with --nudge"},
                                        {{"--temperature", "25"}, "goes with --nudge"},
                                        {{"--sound-speed", "350m/s"}, "goes with --nudge"},
                                        {{"--frequency", "41kHz"}, "goes with --nudge"}}}),
           .untried = "--target --turn --source --frames --out --layout --rig --background --nudge",
           .tried_as = {"calibrate", "--rig", rig, "--frames", "2", "--json", "OUT/found.json"},
           .effective = {{{"--noise-free"}}, {{"--at", "5mm,0,0"}}}},
          {.line = {"calibrate", "--layout", "openmpd", "--background"},
           .idle = joined<IdleOption>({gpu_of_nudge,
                                       {{{"--at", "0,0,1mm"}, "exclude each other"},
                                        {{"--turn", "90"}, "exclude each other"},
                                        {{"--nudge"}, "exclude each other"},
                                        {{"--keys", "enter"}, "--keys goes with --nudge"},
                                        {{"--out", "x.toml"}, "--out needs --source"}}}),
           .tried_as = {"calibrate", "--background", "--rig", rig, "--frames", "10", "--json", "OUT/learned.json"},
           .effective = {{{"--noise-free"}}}},
          {.line = {"calibrate", "--layout", "openmpd", "--target", "none/t.stl"},
           .idle = joined<IdleOption>({gpu_of_nudge,
                                       {{{"--source", "synthetic"}, "exclude each other"},
                                        {{"--frames", "3"}, "exclude each other"},
                                        {{"--noise-free"}, "exclude each other"},
                                        {{"--json", "-"}, "--target only writes the model"},
                                        {{"--out", "x.toml"}, "exclude each other"},
                                        {{"--nudge"}, "exclude each other"},
                                        {{"--background"}, "exclude each other"},
                                        {{"--keys", "enter"}, "--keys goes with --nudge"},
                                        {{"--at", "0,0,1mm"}, "a printer's .stl lies as it is printed"},
                                        {{"--turn", "90"}, "a printer's .stl lies as it is printed"}}}),
           .tried_as = {"calibrate", "--target", "OUT/target.glb", "--layout", "openmpd"},
           .effective = {{{"--at", "5mm,0,0"}},
                         {{"--turn", "90"}},
                         {{"--layout", "sonicsurface"}},
                         {{"--target", "OUT/target.stl"}}}}};
}

std::vector<ReviewedLine> of_drive(const std::string& scratch) {
  const std::vector<std::string> line{"drive", "--layout", "openmpd", "--focus", "0,0,10cm", "--backend", "cpu"};
  const std::string above =
      ply_in(scratch, "above.ply",
             transformed(geometry::icosphere(2e-3, 3), [](const Vec3& p) { return p + Vec3(0, 0, 0.1); }));
  return {{.line = line,
           .idle = joined<IdleOption>({no_gpu,
                                       {{{"--slot", "1"}, "--slot goes with --touch"},
                                        {{"--rig", "x.toml"}, "--rig goes with --touch"},
                                        {{"--mesh", above}, "--mesh goes with --transfer finger"},
                                        {{"--force"}, "--force goes with --transfer finger"},
                                        {{"--draws", "50"}, "--draws goes with --spread"}}}),
           .untried = "--touch --pattern",
           .tried_as = with(line, {"--focus", "2cm,0,10cm", "--json", "OUT/drive.json"}),
           .effective = joined<EffectiveOption>({sounding,
                                                 {{{"--solver", "greedy"}},
                                                  {{"--layout", "autd3"}},
                                                  {{"--focus", "0,0,9cm"}},
                                                  {{"--null", "0,2cm,10cm"}},
                                                  {{"--csv", "OUT/drive.csv"}},
                                                  {{"--transfer", "finger", "--mesh", above}}}})},
          {.line = {"drive", "--layout", "openmpd", "--touch", "x.json", "--backend", "cpu"},
           .idle = {{{"--focus", "0,0,10cm"}, "exclude each other"}}},
          {.line = {"drive", "--layout", "paper", "--pattern", "hoshi", "--backend", "cpu"},
           .idle = {{{"--focus", "0,0,1cm"}, "--focus and --pattern exclude each other"},
                    {{"--null", "2cm,0,0"}, "--null and --pattern exclude each other"},
                    {{"--touch", "x.json"}, "--pattern and --touch exclude each other"}}}};
}

ReviewedLine of_field() {
  const std::vector<std::string> line{"field",  "--layout", "openmpd", "--focus",   "0,0,10cm",
                                      "--line", "0,0,1cm",  "0,0,2cm", "--backend", "cpu"};
  return {.line = line,
          .idle = joined<IdleOption>({no_gpu,
                                      {{{"--centre", "0,0,0"}, "goes with --plane"},
                                       {{"--size", "6mm,6mm"}, "goes with --plane"},
                                       {{"--pixels", "8,8"}, "goes with --plane"},
                                       {{"--draws", "50"}, "--draws goes with --spread"},
                                       {{"--humidity", "20", "--no-absorption"}, "exclude each other"},
                                       {{"--air-pressure", "90kPa", "--no-absorption"}, "exclude each other"}}}),
          .untried = "--drive --plane --points",
          .tried_as = with(line, {"--focus", "2cm,0,10cm", "--json", "OUT/field.json", "--csv", "OUT/field.csv"}),
          .effective = joined<EffectiveOption>({sounding,
                                                {{{"--solver", "greedy"}},
                                                 {{"--layout", "autd3"}},
                                                 {{"--focus", "0,0,9cm"}},
                                                 {{"--null", "0,2cm,10cm"}},
                                                 {{"--line", "0,0,1cm", "0,0,3cm"}},
                                                 {{"--samples", "5"}},
                                                 {{"--csv", "OUT/other.csv"}},
                                                 {{"--vtu", "OUT/field.vtu"}},
                                                 {{"--png", "OUT/field.png"}},
                                                 {{"--no-absorption"}},
                                                 {{"--humidity", "20"}},
                                                 {{"--air-pressure", "90kPa"}}}})};
}

std::vector<ReviewedLine> of_scatter(const std::string& scratch) {
  const geometry::Mesh ball = geometry::icosphere(1e-3, 3);
  const std::string pebble = ply_in(scratch, "pebble.ply", ball);
  const std::string raised =
      ply_in(scratch, "raised.ply", transformed(ball, [](const Vec3& p) { return p + Vec3(0, 0, 0.05); }));
  const std::string drive = scratch + "/drive.csv";
  const array::Layout layout = array::load_layout("openmpd");
  write_text(drive, setup::drive_csv(layout, array::Drive(layout.transducers.size(), {1, 0})));
  const std::vector<std::string> line{"scatter", "--mesh", pebble, "--plane-wave", "0,0,1"};
  const std::vector<std::string> of_array{"scatter", "--mesh", raised, "--layout", "openmpd", "--drive", drive};
  const std::vector<std::string> results{"--json", "OUT/body.json", "--csv", "OUT/faces.csv"};
  return {{.line = line,
           .idle = joined<IdleOption>({no_gpu_at_all(),
                                       {{{"--centre", "0,0,0"}, "goes with --plane"},
                                        {{"--size", "6mm,6mm"}, "goes with --plane"},
                                        {{"--pixels", "8,8"}, "goes with --plane"},
                                        {{"--samples", "9"}, "--samples goes with --line"},
                                        {{"--layout", "openmpd"}, "go together"},
                                        {{"--drive", "x.csv"}, "exclude each other"},
                                        {{"--directivity", "omni"}, "--directivity goes with --drive"},
                                        {{"--humidity", "20"}, "--humidity goes with --absorption"},
                                        {{"--absorption"}, "--absorption goes with --drive"}}}),
           .untried = "--mesh --force --point-source --plane",
           .tried_as = with(line, results),
           .effective = {{{"--plane-wave", "0,1,0"}},
                         {{"--line", "0,0,2mm", "0,0,3mm"}},
                         {{"--samples", "5"}, {"--line", "0,0,2mm", "0,0,3mm"}},
                         {{"--points", raised}},
                         {{"--csv", "OUT/other.csv"}},
                         {{"--temperature", "30"}},
                         {{"--sound-speed", "350m/s"}},
                         {{"--frequency", "41kHz"}},
                         {{"--air-pressure", "90kPa"}}}},
          {.line = of_array,
           .idle = {{{"--humidity", "20"}, "--humidity goes with --absorption"}},
           .tried_as = with(of_array, results),
           .effective = {{{"--directivity", "omni"}}, {{"--absorption"}}, {{"--humidity", "20"}, {"--absorption"}}}}};
}

std::vector<ReviewedLine> of_simulate(const std::string& scratch) {
  const std::string tip =
      ply_in(scratch, "tip.ply", transformed(sphere(2e-3, 8, 12), [](const Vec3& p) { return p + Vec3(0, 2e-3, 0); }));
  const std::vector<std::string> line{"simulate",      "--scene", asset("cube.glb"), "--finger", tip,
                                      "--penetration", "1mm",     "--backend",       "cpu"};
  return {{.line = line,
           .idle = joined<IdleOption>({no_gpu,
                                       felt,
                                       parts,
                                       {{{"--noise-free"}, "--noise-free goes with --skin cameras"},
                                        {{"--finger-width", "10mm"}, "--finger-width goes with --skin cameras"},
                                        {{"--draws", "50"}, "--draws goes with --spread"},
                                        {{"--humidity", "20", "--no-absorption"}, "exclude each other"}}}),
           .untried =
               "--scene --gltf-scene --finger --finger-gap --min-points --skin --figure6 --force --surface --cluster "
               "--stride --modulation --rig",
           .tried_as = with(line, {"--layout", "openmpd", "--json", "OUT/felt.json"}),
           .effective = joined<EffectiveOption>({placed,
                                                 solved,
                                                 sounding,
                                                 {{{"--delta", "1mm"}},
                                                  {{"--foci", "6"}},
                                                  {{"--tune"}},
                                                  {{"--spectrum"}},
                                                  {{"--dwell", "2ms"}, {"--spectrum"}},
                                                  {{"--modulation-frequency", "0"}, {"--method", "single-focus"}},
                                                  {{"--penetration", "0.8mm"}},
                                                  {{"--layout", "sonicsurface"}},
                                                  {{"--transfer", "finger"}},
                                                  {{"--csv", "OUT/faces.csv"}},
                                                  {{"--vtu", "OUT/faces.vtu"}},
                                                  {{"--png", "OUT/finger.png"}},
                                                  {{"--no-absorption"}},
                                                  {{"--humidity", "20"}},
                                                  {{"--air-pressure", "90kPa"}}}})},
          {.line = {"simulate", "--figure6", "--backend", "cpu"},
           .idle = {{{"--scene", asset("cube.glb")}, "exclude each other"},
                    {{"--gltf-scene", "0"}, "exclude each other"},
                    {{"--csv", "x.csv"}, "exclude each other"},
                    {{"--vtu", "x.vtu"}, "exclude each other"},
                    {{"--method", "ellipse"}, "exclude each other"},
                    {{"--spread", "phase=0.1"}, "exclude each other"},
                    {{"--surface", "parts"}, "exclude each other"},
                    {{"--parts", "3"}, "exclude each other"}}}};
}

std::vector<ReviewedLine> of_afferents(const std::string& scratch) {
  const std::string tip = ply_in(scratch, "afferents-tip.ply",
                                 transformed(sphere(2e-3, 8, 12), [](const Vec3& p) { return p + Vec3(0, 2e-3, 0); }));
  const std::vector<std::string> line{"afferents",     "--scene", asset("cube.glb"), "--finger", tip,
                                      "--penetration", "1mm",     "--layout",        "openmpd",  "--duration",
                                      "50ms",          "--json",  "OUT/a.json"};
  return {{.line = line,
           .idle = joined<IdleOption>(
               {no_gpu_at_all(),
                {{{"--linear", "--crest", "16"}, "exclude each other"},
                 {{"--stride", "3", "--method", "single-focus"}, "--stride: a single focus has no order"}}}),
           .untried = "--scene --finger --delta",
           .effective = {{{"--penetration", "0.8mm"}},
                         {{"--x", "1mm"}},
                         {{"--z", "1mm"}},
                         {{"--yaw", "30"}},
                         {{"--method", "ellipse"}},
                         {{"--foci", "6"}},
                         {{"--stride", "1"}},
                         {{"--dwell", "2ms"}},
                         {{"--modulation-frequency", "100"}, {"--method", "single-focus"}},
                         {{"--layout", "sonicsurface"}},
                         {{"--crest", "50"}},
                         {{"--linear"}},
                         {{"--duration", "60ms"}},
                         {{"--bin", "10ms"}},
                         {{"--csv", "OUT/sites.csv"}},
                         {{"--times", "OUT/times.csv"}},
                         {{"--png", "OUT/spikes.png"}}}}};
}

}  // namespace

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;)
    words.push_back(word);
  return words;
}

std::vector<ReviewedLine> reviewed_lines(const std::string& scratch) {
  return joined<ReviewedLine>(
      {{{.line = {"doctor"},
         .idle = joined<IdleOption>({{{{"--source", "bag:x"}, "--source goes with --write-rig"}}, no_gpu_at_all()}),
         .untried = "--write-rig"},
        of_touch(),
        of_run(),
        of_link(),
        of_field(),
        {.line = {"decompose", "--scene", asset("cube.glb"), "--out", "none/x.glb"},
         .idle = no_gpu_at_all(),
         .untried = "--scene --gltf-scene --out --parts --resolution --error"},
        {.line = {"bench", "--suite", "array"},
         .idle = {{{"--scene", asset("cube.glb")}, "--scene goes with --suite surface"},
                  {{"--backend", "cpu"}, "bench measures the GPU"}},
         .untried = "--suite --runs --csv --gpu --validation"}},
       of_studies(),
       of_export(scratch),
       of_played(scratch),
       of_calibrate(),
       of_drive(scratch),
       of_scatter(scratch),
       of_simulate(scratch),
       of_afferents(scratch),
       of_emulate()});
}

}  // namespace palpa::test
