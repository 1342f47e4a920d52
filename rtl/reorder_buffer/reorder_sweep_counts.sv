// SPDX-License-Identifier: Apache-2.0
// Packets per bin of reorder_sweep, and how many the bin in the row's first place holds. That is known in the cycle in
// which the sweep chooses it, although numbers lie in block RAM and an insertion of the cycle before counts: it is
// more_o + joins_o + 1, but for the insertion of its own cycle.
//
// One insertion and one choice a cycle. A number is written two cycles after the insertion, and read from two cycles
// before its bin moves up to the first place.
module reorder_sweep_counts #(
    parameter int unsigned BinBits = 9,
    parameter int unsigned CountBits = 12
) (
    input  logic                 clk_i,
    // the insertion of this cycle; whether it joins places 0, 1, 2 of the row, or is put into place 0 or 1
    input  logic [  BinBits-1:0] insert_bin_i,
    input  logic [          2:0] same_i,
    input  logic [          1:0] at_i,
    // that of a cycle ago: lies ahead in this pass; is in the row because of that
    input  logic [  BinBits-1:0] bin1_i,
    input  logic                 ahead1_i,
    input  logic                 in_row1_i,
    // that of two cycles ago, which is written; its bin was filled before
    input  logic                 write2_i,
    input  logic [  BinBits-1:0] bin2_i,
    input  logic                 known2_i,
    // the row: bins in places 1 and 2; it moves up
    input  logic [2*BinBits-1:0] places_i,
    input  logic                 move_i,
    // packets of the bin in place 0 less one
    output logic [CountBits-1:0] more_o,
    output logic [          1:0] joins_o
);
  // Packets of the bin in place 0 less one, as a sum of two: what was read before it moved up, or the sum of a cycle ago;
  // and what joined since. Both are 0 of a bin that the last insertion put there.
  logic move_q, fresh_q, forward2_q;
  logic [CountBits-1:0] read_q, last2_count_q, sum_q;
  logic [1:0] joins_q;
  assign more_o = fresh_q ? '0 : !move_q ? sum_q : forward2_q ? last2_count_q : read_q;
  assign joins_o = fresh_q ? '0 : joins_q;

  // Packets per bin less one; what stands there counts only while the bin's bit says so. A number is written two cycles
  // after the insertion: one that is read in the cycle of an insertion lacks the insertion before, and what that cycle
  // writes is taken from where it is.
  logic [CountBits-1:0] stored_count, stored_count_q, last_count_q, new_count;
  logic same_count_q, written_q;
  assign new_count = known2_i ? (same_count_q ? last_count_q : stored_count_q) + 1'b1 : '0;
  always_ff @(posedge clk_i) begin
    written_q <= write2_i && bin2_i == insert_bin_i;
    stored_count_q <= written_q ? last_count_q : stored_count;
    same_count_q <= write2_i && bin2_i == bin1_i;
    last_count_q <= new_count;
  end

  block_ram #(
      .Width(CountBits),
      .Depth(1 << BinBits)
  ) counts_insert (
      .clk_i(clk_i),
      .write_i(write2_i),
      .write_address_i(bin2_i),
      .write_data_i(new_count),
      .read_i(1'b1),
      .read_address_i(insert_bin_i),
      .read_data_o(stored_count)
  );

  // The numbers of the bins in places 1 and 2 are read in every cycle, and in the next one that of the bin which is then
  // in place 1 is there, where that bin is one of the two. The insertion of the cycle before the read put the bin there
  // (void), or is added to what was read, as are that of the cycle of the read and that of the next one.
  logic [1:0] void_q, forward_q, joined_q, joining_q;
  logic [2*CountBits-1:0] stored_places;
  logic [1:0] second_joins;
  for (genvar i = 0; i < 2; i++) begin : gen_number
    logic joined;
    assign joined = ahead1_i && bin1_i == places_i[BinBits*i+:BinBits];
    always_ff @(posedge clk_i) begin
      void_q[i] <= joined && in_row1_i;
      forward_q[i] <= write2_i && bin2_i == places_i[BinBits*i+:BinBits];
      joined_q[i] <= joined && !in_row1_i;
      joining_q[i] <= same_i[i+1];
    end

    block_ram #(
        .Width(CountBits),
        .Depth(1 << BinBits)
    ) counts (
        .clk_i(clk_i),
        .write_i(write2_i),
        .write_address_i(bin2_i),
        .write_data_i(new_count),
        .read_i(1'b1),
        .read_address_i(places_i[BinBits*i+:BinBits]),
        .read_data_o(stored_places[CountBits*i+:CountBits])
    );
  end
  assign second_joins = 2'(joined_q[move_q]) + 2'(joining_q[move_q]) + 2'(same_i[1]);
  always_ff @(posedge clk_i) begin
    read_q <= move_q ? stored_places[CountBits+:CountBits] : stored_places[0+:CountBits];
    if (void_q[move_q]) read_q <= '0;
    forward2_q <= forward_q[move_q] && !void_q[move_q];
    last2_count_q <= last_count_q;

    move_q <= move_i;
    fresh_q <= move_i ? at_i[1] : at_i[0];
    sum_q <= more_o + CountBits'(joins_o);
    joins_q <= move_i ? second_joins : 2'(same_i[0]);
  end
endmodule
