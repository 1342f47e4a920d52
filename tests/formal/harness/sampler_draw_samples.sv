// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/gatherer_pkg.sv
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/fifo.sv rtl/common/multiplier.sv rtl/common/less_than.sv
// sources: rtl/cdf_sampler/cdf_sampler_search.sv rtl/cdf_sampler/cdf_sampler_draw.sv
// cdf_sampler_draw, whose samples are those of cdf_sampler: a request is let go only where there will be room for its sample, so
// no FIFO beside the search or behind it ever overflows or runs dry, and there is a credit where nothing is under way; and a
// sample stays and holds, bit for bit, until it is taken. The module's own assertions count too. Tables, totals and times of
// requests are any.
module sampler_draw_samples #(
    parameter int unsigned Lemmas = 0,
    localparam int unsigned Latency = 9,
    localparam int unsigned OutDepth = 16
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_table_i,
    input logic [1:0] in_u_i,
    input logic in_tag_i,
    input logic [1:0] in_v_i,
    input logic write_i,
    input logic write_table_i,
    input logic [1:0] write_cell_i,
    input logic [3:0] write_prefix_i,
    input logic [1:0] finished_i,
    input logic [7:0] totals_i,
    input logic [1:0] pixels_i,
    input logic [1:0] samples_i,
    input logic out_ready_i
);
  (* anyconst *) logic [3:0] followed;
  logic in_ready, out_valid;
  photonloom_pkg::sample_t out;

  cdf_sampler_draw #(
      .CellBits(1),
      .ProbabilityBits(2),
      .UBits(2),
      .VBits(1),
      .RequestDepth(2)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_table_i(in_table_i),
      .in_u_i(in_u_i),
      .in_tag_i(in_tag_i),
      .in_v_i(in_v_i),
      .write_i(write_i),
      .write_table_i(write_table_i),
      .write_cell_i(write_cell_i),
      .write_prefix_i(write_prefix_i),
      .finished_i(finished_i),
      .totals_i(totals_i),
      .pixels_i(pixels_i),
      .samples_i(samples_i),
      .owing_o(),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out)
  );

  (* keep *) logic [4:0] out_head, out_tail, side_head, side_tail, credit;  // probes
  (* keep *) logic [Latency:1] under_way;  // probe
  logic [4:0] going, beside;  // samples between issue and their FIFO, those whose request is in the FIFO beside the search
  always_comb begin
    beside = '0;
    for (int unsigned i = 2; i <= Latency; i++) beside = beside + 5'(under_way[i]);
    going = beside + 5'(under_way[1]);
  end

  logic started_q = 1'b0, stalled_q, shown_q;
  logic [15:0] bits;
  assign bits = 16'(out);
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    stalled_q <= !rst_i && out_valid && !out_ready_i;
    shown_q   <= bits[followed];
  end
  always_comb begin
    assume (rst_i == !started_q);
    if (!rst_i) begin
      if (stalled_q) assert (out_valid && bits[followed] == shown_q);
      if (under_way == '0 && !out_valid) assert (credit == 5'(OutDepth));
    end
  end

  if (Lemmas == 1) begin : gen_lemmas
    always_comb begin
      if (!rst_i) begin
        assert (5'(out_tail - out_head) <= 5'(OutDepth) && credit <= 5'(OutDepth));
        assert (6'(credit) + 6'(going) + 6'(5'(out_tail - out_head)) == 6'(OutDepth));
        assert (5'(side_tail - side_head) == beside);
      end
    end
  end
endmodule
