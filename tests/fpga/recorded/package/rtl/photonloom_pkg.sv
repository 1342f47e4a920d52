// SPDX-License-Identifier: Apache-2.0
  localparam int unsigned GatherQueryPacketBits = 88;  // width of gather_query_t
  localparam int unsigned GatherResultPacketBits = 262;  // width of gather_result_t
  localparam int unsigned GatherPhotonPacketBits = 99;  // width of gather_photon_t
  localparam int unsigned SamplerInputPacketBits = 135;  // width of sampler_input_t
  localparam int unsigned SamplePacketBits = 93;  // width of sample_t
