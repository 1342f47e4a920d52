// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/fifo.sv rtl/common/oct_decode.sv rtl/photon_gatherer/photon_gatherer_pairs.sv
// photon_gatherer_pairs of eight lanes: what is known ahead, whether at most one group of two lanes is left of the beat that
// is tested, is so, and with it a beat ends exactly where nothing would be left of it. Beats are any.
module pairs_last_group (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_last_i,
    input logic [7:0] in_mask_i,
    input logic [7:0] in_d2_i,
    input logic out_ready_i,
    output logic in_ready_o,
    output logic out_valid_o
);
  photon_gatherer_pairs #(
      .R2Bits(1),
      .Contexts(2),
      .Bucket(8),
      .Lanes(8),
      .RowBits(1),
      .DirectionBits(2),
      .NormalBits(2)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_context_i(1'b0),
      .in_beat_i(1'b0),
      .in_row_i(1'b0),
      .in_last_i(in_last_i),
      .in_mask_i(in_mask_i),
      .in_d2_i(in_d2_i),
      .direction_read_o(),
      .directions_i('0),
      .normal_context_o(),
      .normal_i('0),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_context_o(),
      .out_row_o(),
      .out_last_o(),
      .out_first_o(),
      .out_front_o(),
      .out_candidates_o()
  );

  (* keep *) logic held, one_left, test, finished;  // probes
  (* keep *) logic [7:0] mask, rest;  // probes
  logic [2:0] groups;
  always_comb begin
    groups = '0;
    for (int unsigned g = 0; g < 4; g++) groups = groups + 3'(mask[2*g] || mask[2*g+1]);
  end

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb begin
    assume (rst_i == !started_q);
    if (!rst_i) begin
      if (held) assert (one_left == (groups < 3'd2));
      assert (finished == (test && rest == '0));
    end
  end
endmodule
