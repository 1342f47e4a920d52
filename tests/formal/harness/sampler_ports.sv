// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/gatherer_pkg.sv
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/skid_buffer.sv rtl/common/fifo.sv rtl/common/less_than.sv
// sources: rtl/common/multiplier.sv rtl/common/oct_decode.sv rtl/common/reciprocal.sv rtl/common/counter.sv
// sources: rtl/cdf_sampler/cdf_sampler.sv rtl/cdf_sampler/cdf_sampler_cosine_total.sv rtl/cdf_sampler/cdf_sampler_draw.sv
// sources: rtl/cdf_sampler/cdf_sampler_jacobian.sv rtl/cdf_sampler/cdf_sampler_levels.sv rtl/cdf_sampler/cdf_sampler_power.sv
// sources: rtl/cdf_sampler/cdf_sampler_search.sv rtl/cdf_sampler/cdf_sampler_weights.sv
// cdf_sampler, whole, for the paths between its ports.
module sampler_ports (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::sampler_input_t in_i,
    input logic out_ready_i,
    output logic in_ready,
    output logic out_valid
);
  photonloom_pkg::sample_t out;

  cdf_sampler #(
      .RequestDepth(2)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out),
      .count_tables_o(),
      .count_photons_o(),
      .count_samples_o(),
      .count_cycles_busy_o(),
      .count_cycles_building_o()
  );
endmodule
