# SPDX-License-Identifier: Apache-2.0
# vivado -mode batch -source board/vivado.tcl, from the folder of the package; leaves
# build/@TOP@.bit and reports beside it. Written to the vendor's documentation and not run on
# the vendor's tool.
file mkdir build
create_project -in_memory -part @DEVICE@
read_verilog -sv [split [string trim [read [open files.f]]]]
read_xdc @CONSTRAINTS@
synth_design -top @TOP@
report_utilization -file build/@TOP@.synthesis.txt
opt_design
place_design
phys_opt_design
route_design
report_utilization -file build/@TOP@.utilization.txt
report_timing_summary -file build/@TOP@.timing.txt
write_bitstream -force build/@TOP@.bit
if {[get_property SLACK [get_timing_paths]] < 0} {
  puts "ERROR: the clock is not met, see build/@TOP@.timing.txt"
  exit 1
}
