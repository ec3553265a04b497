# Checks #include lines against the layering: includes point downward only, between libraries and between the folders
# of a library.
#   awk -f tests/house/arrows.awk FILE...      (paths from the project's root)

BEGIN {
  split("base line drawing gpu geometry sensation sensing touch array acoustics study observer session setup experiment bench cli", floor_names)
  for (i in floor_names) floor_of[floor_names[i]] = i + 0

  # driver/ uses the engine only through its small interfaces.
  interface["session/links/link.hpp"] = interface["session/links/sources.hpp"] = 1  # the names of both on the command
                                                                                    # line
  interface["session/links/slots.hpp"] = 1      # the slots that a plan plays, up to the boards
  interface["session/links/real_time_service.hpp"] = 1  # a guard has no library for it
  interface["session/links/hand_over.hpp"] = 1  # a link's messages about what it was given
  interface["session/links/board_sound.hpp"] = 1  # what it knows of its board's sound
  interface["sensing/depth_source.hpp"] = interface["sensing/camera.hpp"] = interface["sensing/rig.hpp"] = 1
  interface["sensing/grey_png.hpp"] = 1       # the images of a recording
  interface["cli/doctor.hpp"] = 1             # its section of palpa doctor
  interface["bench/row.hpp"] = 1              # its rows of palpa bench
  interface["cli/command.hpp"] = interface["setup/options/options.hpp"] = interface["line/values.hpp"] = 1  # its commands
  interface["array/transducer_drive.hpp"] = interface["array/layouts/layout.hpp"] = interface["array/schedule.hpp"] = 1
  interface["array/layouts/board_types.hpp"] = 1  # what a board can play
  interface["array/layouts/changes.hpp"] = 1  # how it goes from drive to drive
  interface["acoustics/field/incident.hpp"] = interface["acoustics/air.hpp"] = 1  # the sound of an emulator's bytes

  # The folders of a library, and the headers at its top that they know, lowest first: each may include the earlier ones.
  # "." is everything else at the library's top.
  order("array", "transducer_drive medium amplitudes layouts field drive_options solvers nulls pressures .")
  order("touch", "types stage_setting capacity pass_watch contacts points fingers methods .")
  order("acoustics", "air lanes field elements boundary compressed bodies felt .")
  order("geometry", "text haptics part_of symmetric seeded_hash mesh gltf_document gltf files parts surface .")
  order("session", "clock newest threads answer_thread links watch predict plan loop previews . control")
  order("study", "statistics tables pages plan files sitting . report")
  order("observer", "afferents . predicted")
  order("setup", "process files options sessions tasks")
  order("cli", ". study")
  order("viewer", "view picture hands render sound live study options panel_data panels app window run .")
  bad = 0
}

function order(library, names,    i, n, name) {
  n = split(names, name, " ")
  for (i = 1; i <= n; i++) step_of[library, name[i]] = i
}

# The place of a library's file: its folder, its own name at the top if the folders know it, or ".".
function place(library, inside,    part, stem) {
  if (split(inside, part, "/") > 1) return part[1]
  stem = inside
  sub(/\.[a-z]+$/, "", stem)
  return (library, stem) in step_of ? stem : "."
}

FNR == 1 {
  split(FILENAME, path, "/")
  house = path[1]                             # engine, driver, viewer, assets
  library = house == "engine" ? path[2] : house
  inside = FILENAME
  sub(house == "engine" ? "^engine/[^/]*/" : "^[^/]*/", "", inside)
  here = place(library, inside)
  if (((library, ".") in step_of) && !((library, here) in step_of)) fault(here "/ has no place among the folders of " library " (arrows.awk)")
}

function fault(text) {
  printf "   %s:%d: %s\n", FILENAME, FNR, text
  bad = 1
}

/^[ \t]*#[ \t]*include[ \t]*[<"]/ {
  match($0, /[<"][^>"]+[>"]/)
  name = substr($0, RSTART + 1, RLENGTH - 2)
  split(name, part, "/")
  target = name ~ /\// ? part[1] : ""

  if (target == library && ((library, ".") in step_of)) {
    there = substr(name, length(library) + 2)
    there = place(library, there)
    if (step_of[library, there] > step_of[library, here])
      fault(library ": " (here == "." ? "the top" : here) " may not include " name ", which is above it")
  }

  if (name ~ /^(GLFW\/|glfw)/ && FILENAME !~ /^viewer\/.*window/) fault("only the viewer's window may know GLFW")
  if (name ~ /^(volk\.h|vulkan\/)/ && library ~ /^(base|line|drawing|setup|experiment|cli|driver|assets)$/) fault(library " may not know Vulkan")

  if (house == "engine") {
    if (target ~ /^(driver|viewer|assets|tests)$/) fault("engine/ may not include " name ", which is above it")
    if ((target in floor_of) && floor_of[target] > floor_of[library]) fault(library "/ may not include " name ", which is above it")
    if (library == "observer" && target == "study" && name !~ /^study\/(statistics|tables|pages)\//)
      fault("observer/ may not include " name ": of a study, it knows only tables, statistics and pages")
    if (library ~ /^(array|acoustics)$/ && target ~ /^(sensing|touch)$/) fault(library "/ may not include " name ": sound knows no fingers")
  } else if (house == "driver") {
    if (target ~ /^(viewer|assets|tests)$/) fault("driver/ may not include " name)
    # The program's main() is where engine and driver meet.
    if (FILENAME != "driver/main.cpp" && (target in floor_of) && target != "base" && !(name in interface))
      fault("driver/ may not include " name ": it uses the engine's small interfaces only")
  } else if (house == "viewer" && target ~ /^(cli|assets|tests)$/) {
    fault("viewer/ may not include " name)
  } else if (house == "assets" && (target in floor_of) && target !~ /^(base|geometry|sensing|array)$/) {
    fault("the generators in assets/ may not include " name)
  }
}

END { exit bad }
