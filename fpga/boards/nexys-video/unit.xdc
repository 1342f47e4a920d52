# SPDX-License-Identifier: Apache-2.0
# Pins and clock of a Nexys Video: a unit alone, on the oscillator, a button and an LED.
set_property CFGBVS VCCO [current_design]
set_property CONFIG_VOLTAGE 3.3 [current_design]
create_clock -name oscillator -period @PIN_NS@ [get_ports clk_100mhz]
set_property -dict {PACKAGE_PIN R4 IOSTANDARD LVCMOS33} [get_ports {clk_100mhz}]
set_property -dict {PACKAGE_PIN B22 IOSTANDARD LVCMOS12} [get_ports {btn_i}]
set_property -dict {PACKAGE_PIN T14 IOSTANDARD LVCMOS25} [get_ports {led_o}]
