#!/usr/bin/env bash
# run.sh [--openmpd DIR] [--openmpd-boards DIR] [--sonicsurface DIR] [--palpa FILE]: the makers' own firmware of boards on the
# bytes that palpa sends.
#
# DIR is a clone of the makers' repository, with or without a work tree: OpenMPD_Hardware (PALPA_OPENMPD_HARDWARE), OpenMPD_Libs
# with the files of their boards (PALPA_OPENMPD_LIBS; or a folder with such files), SonicSurface (PALPA_SONICSURFACE). They are
# no parts of palpa, and OpenMPD's has no licence. What is made of them lies in a scratch folder, which is deleted at the end.
# GHDL makes Verilog of their VHDL, Verilator makes a program of that, and pins.hpp has the shift registers behind the board.
# cases.py lets palpa play, and compares every pulse with the drive that palpa intended. tests/python/test_board_bytes.py does the
# same without the simulators, by the rules of boards.py and decoded.py.
#
# PALPA_FIRMWARE_KEEP: if set, the scratch folder stays.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

openmpd=${PALPA_OPENMPD_HARDWARE-} boards=${PALPA_OPENMPD_LIBS-} sonicsurface=${PALPA_SONICSURFACE-} palpa=
die() {
  printf 'test firmware: %s\n' "$*" >&2
  exit 1
}
while (($#)); do
  case $1 in
    --openmpd | --openmpd-boards | --sonicsurface | --palpa)
      [[ ${2-} ]] || die "$1 needs a path"
      printf -v "${1##*-}" %s "$2"
      shift 2
      ;;
    *) die "what is $1? Usage: ./dev test firmware [--openmpd DIR] [--openmpd-boards DIR] [--sonicsurface DIR]" ;;
  esac
done
if [[ -z $openmpd$sonicsurface ]]; then
  echo "firmware: skipped: it needs a clone of github.com/RMResearch/OpenMPD_Hardware (--openmpd DIR or PALPA_OPENMPD_HARDWARE)," \
    "or of github.com/upnalab/SonicSurface (--sonicsurface DIR or PALPA_SONICSURFACE)"
  exit
fi
# What another palpa than this one sends is compared as it is, e.g. that of an older commit.
if [[ -z $palpa ]]; then
  ./dev deps firmware || true
  ./dev build release palpa palpa-guard
  palpa=build/release/bin/palpa
fi
for tool in ghdl verilator c++; do
  command -v "$tool" >/dev/null || {
    echo "firmware: skipped: there is no $tool here: ./dev deps firmware installs it"
    exit
  }
done
/usr/bin/python3 -c 'import numpy' 2>/dev/null || die "/usr/bin/python3 has no NumPy: ./dev deps build installs it"
palpa=$(realpath "$palpa")

here=$PWD/tests/firmware
work=$(mktemp -d "${TMPDIR:-/tmp}/fw.XXXXXX") # short, because the names of sockets in it are limited
[[ -n ${PALPA_FIRMWARE_KEEP-} ]] || trap 'rm -rf "$work"' EXIT
verilated=$(verilator --getenv VERILATOR_ROOT)/include
compile=(c++ -std=c++20 -O1 -w -I"$verilated" -I"$verilated/vltstd" -I"$here")

# part NAME DIR FILE...: these files of a clone in the scratch folder, also if they are only in its history. NAME is that of no
# program.
part() {
  local to=$work/$1.clone from=$2 file
  shift 2
  mkdir -p "$to"
  for file; do
    mkdir -p "$to/$(dirname "$file")"
    if [[ -e $from/$file ]]; then
      cp -r "$from/$file" "$to/$file"
    else
      git -C "$from" archive HEAD "$file" | tar -x -C "$to" || die "$from has no $file"
    fi
  done
  printf '%s\n' "$to"
}

# model NAME VERILOG...: compiles V_NAME.
model() {
  local name=$1 out=$work/v_$1 source
  shift
  verilator --cc -O3 --x-assign fast --x-initial fast --noassert -Wno-fatal -Wno-lint -Wno-style -Wno-INITIALDLY -Wno-COMBDLY -Wno-UNOPTFLAT \
    --prefix "V_$name" --top-module "$name" --Mdir "$out" "$@" >"$out.log" 2>&1 || die "Verilator: $(grep -m 3 '^%Error' "$out.log")"
  for source in "$out"/*.cpp; do "${compile[@]}" -c "$source" -o "${source%.cpp}.o"; done
}
synth=(ghdl --synth --std=93 -fsynopsys -fexplicit --syn-binding -Wno-hide -Wno-binding --out=verilog)

for source in verilated verilated_threads; do "${compile[@]}" -c "$verilated/$source.cpp" -o "$work/$source.o"; done
# program NAME SOURCE MODELS OPTION...
program() {
  local name=$1 source=$2 models=$3 objects=() each
  shift 3
  local compile_with=()
  for each in $models; do objects+=("$work/v_$each"/*.o) && compile_with+=(-I"$work/v_$each"); done
  "${compile[@]}" -O2 "${compile_with[@]}" "$@" "$here/$source" "${objects[@]}" "$work"/verilated*.o -pthread -o "$work/$name"
}

# ---- SonicSurface: block diagrams on top of VHDL ----
# firmware NAME FOLDER
firmware() {
  local name=$1 folder=$2/src top=$work/$1.vhd entity sources=()
  python3 "$here/block_diagram.py" "$folder/QuadrupleBuffer.bdf" "$name" >"$top"
  for entity in PhaseLine Mux8 $(sed -n 's/^  component \(\w*\) is.*/\1/p' "$top"); do
    [[ $entity == Masterclock ]] || sources+=("$folder/$entity.vhd")
  done
  # GHDL 2 understands an element that is chosen by number and inverted only in this form.
  sed -i -E "s/s_enabled\( *(to_integer\(unsigned\(pulse_length\)\)) *\) *<= *NOT.*/for i in s_enabled'range loop if i = \\1 then s_enabled(i) <= not s_enabled(i); end if; end loop;/" "$folder/AllChannels.vhd"
  "${synth[@]}" "$here/stubs/masterclock.vhd" "${sources[@]}" "$top" -e "$name" >"$work/$name.v" 2>"$work/$name.log" ||
    die "GHDL: $(head -n 3 "$work/$name.log")"
  perl -pi -e 's/"([01]+)"/length($1) . "\x27b$1"/ge' "$work/$name.v" # it writes long numbers of ones as texts
  model "$name" "$work/$name.v"
}
arguments=()
if [[ -n $sonicsurface ]]; then
  clone=$(part sonicsurface "$sonicsurface" Firmware ControlSoftware)
  for each in primary:primary secondary:secondary "tactile:tactile modulation"; do
    firmware "${each%%:*}" "$clone/Firmware/FPGA ${each#*:}"
  done
  line=(-DBAUD=230400.0)
  program plain sonicsurface.cpp primary "${line[@]}" -DMODEL=V_primary -DPERIOD_CLOCKS=256
  program sonicsurface_pair sonicsurface.cpp "primary secondary" "${line[@]}" -DMODEL=V_primary -DPERIOD_CLOCKS=256 -DPAIR
  program tactile sonicsurface.cpp tactile "${line[@]}" -DMODEL=V_tactile -DPERIOD_CLOCKS=128
  arguments+=(--sonicsurface "$clone")
fi

# ---- OpenMPD: VHDL, with models of Altera's blocks ----
if [[ -n $openmpd ]]; then
  clone=$(part openmpd "$openmpd" FPGA_3.4.2/src)
  folder=$clone/FPGA_3.4.2/src
  # GHDL wants the bounds of a constant that a case uses.
  sed -i -E 's/(constant\s+\w+\s*:\s*std_logic_vector)(\s*:=\s*"[01]{2}")/\1(1 downto 0)\2/I' "$folder/ParallelReceiver.vhd"
  sources=()
  for entity in RSSFilter Counter ParallelReceiver FrameBufferFIFO FrameBufferController CommandReader GammaCorrectionLUT GammaCorrection \
    Distribute PinMapping PhaseCalibration CalibrationAndMapping PhaseRAM AmplitudeRAM MuxPhase PulseWidthModulator AllChannels top; do
    sources+=("$folder/$entity.vhd")
  done
  ghdl -a --std=93 -fsynopsys --work=altera_mf --workdir="$work" "$here/stubs/altera_mf.vhd"
  "${synth[@]}" --workdir="$work" -P"$work" "${sources[@]}" -e top >"$work/top.v" 2>"$work/top.log" || die "GHDL: $(grep -m 3 -v warning "$work/top.log")"
  # This GHDL leaves the pins of a part open that it both reads and writes, and makes an empty PLL.
  sed -i 's/\.usb_data()/.usb_data(USB_DATA)/; /^module Masterclock/,/^endmodule/d' "$work/top.v"
  model openmpd_board "$work/top.v" "$here/stubs/openmpd_board.v"
  program openmpd openmpd.cpp openmpd_board
  ln -s openmpd "$work/openmpd_pair"
  arguments+=(--openmpd)
  # The files of their boards, as text.
  if [[ -n $boards ]]; then
    mkdir "$work/boards"
    if [[ -n $(find "$boards" -name 'board_*.pat' -print -quit) ]]; then
      find "$boards" -name 'board_*.pat' -exec cp --backup=numbered {} "$work/boards" \;
    else
      git -C "$boards" ls-tree -r --name-only HEAD | grep '/board_[^/]*\.pat$' | while IFS= read -r file; do
        git -C "$boards" show "HEAD:$file" >"$work/boards/$(tr / - <<<"$file")"
      done || die "$boards has no board_*.pat"
    fi
    arguments+=(--boards "$work/boards")
  fi
fi

/usr/bin/python3 "$here/cases.py" "$work" "$palpa" "${arguments[@]}"
