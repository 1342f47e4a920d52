// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/skid_buffer.sv rtl/common/fifo.sv rtl/common/counter.sv
// sources: rtl/common/less_than.sv rtl/common/multiplier.sv rtl/common/squared_distance.sv
// sources: rtl/irradiance_cache/irradiance_weight.sv rtl/irradiance_cache/irradiance_list.sv
// sources: rtl/irradiance_cache/irradiance_cache.sv tests/formal/harness/stream_checks.sv
// irradiance_cache, whole, at its ports: lookups are answered in order, each once at most, the word being its pixel, which
// the unit only carries; and the law of streams, for any bit of the answer. That each is: irradiance_cache_progress.
module irradiance_cache_stream #(
    parameter int unsigned Order = 1,
    parameter int unsigned Law = 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::cache_lookup_t in_i,
    input logic out_ready_i,
    output logic in_ready,
    output logic out_valid
);
  (* anyconst *) logic [3:0] watched;
  photonloom_pkg::cache_result_t out;
  logic [photonloom_pkg::CacheResultPacketBits-1:0] bits;
  assign bits = out;

  irradiance_cache dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out),
      .count_lookups_o(),
      .count_hits_o(),
      .count_records_made_o(),
      .count_full_o(),
      .count_records_read_o(),
      .count_cycles_busy_o(),
      .count_cycles_waiting_o()
  );

  stream_checks #(
      .Order(Order),
      .Law(0),
      .Progress(0)
  ) order (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_i(in_ready),
      .in_i(in_i.pixel),
      .out_valid_i(out_valid),
      .out_ready_i(out_ready_i),
      .out_i(out.pixel)
  );

  logic started_q = 1'b0;
  logic stalled_q, shown_q;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    stalled_q <= !rst_i && out_valid && !out_ready_i;
    shown_q   <= bits[watched];
  end
  always_comb assume (rst_i == !started_q);
  always_comb assume (watched < photonloom_pkg::CacheResultPacketBits);

  if (Law == 1) begin : gen_law
    always_comb begin
      if (!rst_i && stalled_q) assert (out_valid && bits[watched] == shown_q);
    end
  end
endmodule
