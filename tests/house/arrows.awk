# Checks #include lines against the house: arrows point downward only.
#   awk -f tests/house/arrows.awk FILE...      (paths from the project's root)

BEGIN {
  split("base drawing gpu geometry sensing touch array acoustics session setup bench cli", floor_names)
  for (i in floor_names) floor_of[floor_names[i]] = i + 0

  # driver/ sees the engine through its small interfaces only.
  interface["session/links/link.hpp"] = interface["session/links/sources.hpp"] = 1  # how both are named on the command line
  interface["session/links/hand_over.hpp"] = 1  # what a link says of what it was handed
  interface["sensing/depth_source.hpp"] = interface["sensing/camera.hpp"] = interface["sensing/rig.hpp"] = 1
  interface["cli/doctor.hpp"] = 1             # its section of palpa doctor
  interface["bench/row.hpp"] = 1              # its rows of palpa bench
  interface["cli/command.hpp"] = interface["setup/options.hpp"] = interface["setup/values.hpp"] = 1  # its commands
  interface["array/drive.hpp"] = interface["array/layout.hpp"] = interface["array/schedule.hpp"] = 1
  interface["acoustics/field/incident.hpp"] = interface["acoustics/air.hpp"] = 1  # what an emulator's bytes sound like
  bad = 0
}

FNR == 1 {
  split(FILENAME, path, "/")
  house = path[1]                             # engine, driver, viewer, assets
  room = house == "engine" ? path[2] : house
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

  if (name ~ /^(GLFW\/|glfw)/ && FILENAME !~ /^viewer\/.*window/) fault("only the viewer's window may know GLFW")
  if (name ~ /^(volk\.h|vulkan\/)/ && room ~ /^(base|drawing|setup|cli|driver|assets)$/) fault(room " may not know Vulkan")

  if (house == "engine") {
    if (target ~ /^(driver|viewer|assets|tests)$/) fault("engine/ may not include " name ", which is above it")
    if ((target in floor_of) && floor_of[target] > floor_of[room]) fault(room "/ may not include " name ", which is above it")
    if (room ~ /^(array|acoustics)$/ && target ~ /^(sensing|touch)$/) fault(room "/ may not include " name ": sound knows no fingers")
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
