// SPDX-License-Identifier: Apache-2.0
// What a kernel tells its tool beside C++, as macros: pragmas for Vitis HLS, instrumentation in
// native runs, nothing elsewhere (Catapult and Bambu take the same from their scripts). Not run on
// a vendor's tool.
#pragma once

#define PHOTONLOOM_HLS_TEXT(...) #__VA_ARGS__
#define PHOTONLOOM_HLS_PRAGMA(...) _Pragma(PHOTONLOOM_HLS_TEXT(__VA_ARGS__))

#if defined(PHOTONLOOM_HLS_NATIVE)

#include "hls_kernels/native/simulation.hpp"

// A loop whose turns start `interval` cycles apart.
#define HLS_PIPELINE(interval) ::photonloom_hls::turn(interval)
// All turns at once.
#define HLS_UNROLL
// Every element, or every element of dimension `dim`, is a register or memory of its own.
#define HLS_PARTITION(array, dim)
// A turn reads what a turn at least `distance` before wrote to `array`, nothing later.
#define HLS_DISTANCE(array, distance)
// A stream inside a kernel.
#define HLS_STREAM(Toolset, Packet, name, depth) \
  typename Toolset::template stream<Packet> name(#name, depth)
// Processes beside each other.
#define HLS_DATAFLOW ::photonloom_hls::Dataflow dataflow_
#define HLS_PROCESS(name, ...) dataflow_.add(#name, [&] { __VA_ARGS__; })
#define HLS_DATAFLOW_END dataflow_.run()
// A stream of a testbench.
#define HLS_CHANNEL(Toolset, Packet, name, depth) Toolset::stream<Packet> name(#name, depth)
// A top function and its ports.
#define HLS_TOP
#define HLS_PORT_STREAM(name)
#define HLS_PORT_MEMORY(name, words)
#define HLS_PORT_REGISTER(name)
#define HLS_PORT_CONTROL

#elif defined(PHOTONLOOM_HLS_VITIS)

#define HLS_PIPELINE(interval) PHOTONLOOM_HLS_PRAGMA(HLS PIPELINE II = interval)
#define HLS_UNROLL PHOTONLOOM_HLS_PRAGMA(HLS UNROLL)
#define HLS_PARTITION(array, dimension) \
  PHOTONLOOM_HLS_PRAGMA(HLS ARRAY_PARTITION variable = array type = complete dim = dimension)
#define HLS_DISTANCE(array, turns)                                                              \
  PHOTONLOOM_HLS_PRAGMA(HLS DEPENDENCE variable = array type = inter direction = RAW distance = \
                            turns true)
#define HLS_STREAM(Toolset, Packet, name, places)        \
  typename Toolset::template stream<Packet> name(#name); \
  PHOTONLOOM_HLS_PRAGMA(HLS STREAM variable = name depth = places)
#define HLS_DATAFLOW PHOTONLOOM_HLS_PRAGMA(HLS DATAFLOW)
#define HLS_PROCESS(name, ...) __VA_ARGS__
#define HLS_DATAFLOW_END
#define HLS_CHANNEL(Toolset, Packet, name, depth) Toolset::stream<Packet> name(#name)
#define HLS_TOP
#define HLS_PORT_STREAM(name) PHOTONLOOM_HLS_PRAGMA(HLS INTERFACE mode = axis port = name)
#define HLS_PORT_MEMORY(name, words) \
  PHOTONLOOM_HLS_PRAGMA(HLS INTERFACE mode = m_axi port = name bundle = name depth = words)
#define HLS_PORT_REGISTER(name) PHOTONLOOM_HLS_PRAGMA(HLS INTERFACE mode = s_axilite port = name)
#define HLS_PORT_CONTROL PHOTONLOOM_HLS_PRAGMA(HLS INTERFACE mode = s_axilite port = return )

#else

#define HLS_PIPELINE(interval)
#define HLS_UNROLL
#define HLS_PARTITION(array, dim)
#define HLS_DISTANCE(array, distance)
#define HLS_STREAM(Toolset, Packet, name, depth) \
  static typename Toolset::template stream<Packet> name
#define HLS_DATAFLOW
#define HLS_PROCESS(name, ...) __VA_ARGS__
#define HLS_DATAFLOW_END
#define HLS_CHANNEL(Toolset, Packet, name, depth) Toolset::stream<Packet> name
#define HLS_TOP PHOTONLOOM_HLS_PRAGMA(hls_design top)
#define HLS_PORT_STREAM(name)
#define HLS_PORT_MEMORY(name, words)
#define HLS_PORT_REGISTER(name)
#define HLS_PORT_CONTROL

#endif
