# SPDX-License-Identifier: Apache-2.0
# cmake -DRTL=DIR -DOUT=DIR -P verilate.cmake: the board's end of the host link, board/host_link.sv below RTL, as C++. OUT gets
# Vhost_link.h, board_link_rtl.cpp with all that Verilator makes of it, and include, Verilator's own headers and runtime.
file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT}/made)
execute_process(COMMAND verilator --getenv VERILATOR_ROOT OUTPUT_VARIABLE root OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(CREATE_LINK ${root}/include ${OUT}/include SYMBOLIC)
# Of a plan the link reads only what memories are made of, which does not show in simulation.
file(WRITE ${OUT}/photonloom_pkg.sv "package photonloom_pkg;\n  localparam int unsigned LutRamWords = 0;\nendpackage\n")
execute_process(COMMAND verilator --cc -O3 --assert --x-initial unique --x-assign unique --top-module host_link --Mdir ${OUT}/made
  -y ${RTL}/board -y ${RTL}/common ${OUT}/photonloom_pkg.sv ${RTL}/board/host_link.sv COMMAND_ERROR_IS_FATAL ANY)
# One file, whose name depends on no version, so that its coverage can be asked for.
file(GLOB sources ${OUT}/made/*.cpp)
foreach(source IN LISTS sources)
  file(READ ${source} text)
  file(APPEND ${OUT}/board_link_rtl.cpp "${text}")
endforeach()
file(GLOB headers ${OUT}/made/*.h)
file(COPY ${headers} DESTINATION ${OUT})
