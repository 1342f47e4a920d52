// SPDX-License-Identifier: Apache-2.0
// How often each bin of reorder_lists was filled and emptied since reset: which of its four lists is next in turn, and
// whether that list is empty. One insertion and one removal a cycle, of any bins; operations are in one order, an
// insertion before the removal of its cycle.
//
// Bin and turn come 3 cycles after the operation, first_o and linked_o 5. With n packets in the bin an insertion finds its
// list empty iff n < 4; behind the packet that a removal takes another one is linked iff n > 4. Both numbers of a bin
// stand in block RAM twice, as each operation reads both. They are written two cycles after they were read, and of the two
// operations that a read has not seen the result is taken from where it is.
module reorder_counts #(
    parameter int unsigned Packets = 2048,
    parameter int unsigned Bins = 512,
    localparam int unsigned BinBits = Bins > 1 ? $clog2(Bins) : 1
) (
    input  logic               clk_i,
    input  logic               rst_i,
    input  logic               clear_i,       // clear_bin_i's counts are 0; no operation is under way
    input  logic [BinBits-1:0] clear_bin_i,
    input  logic               insert_i,
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic               remove_i,
    input  logic [BinBits-1:0] remove_bin_i,
    output logic [BinBits-1:0] insert_bin_o,
    output logic [        1:0] insert_turn_o,
    output logic               first_o,
    output logic [BinBits-1:0] remove_bin_o,
    output logic [        1:0] remove_turn_o,
    output logic               linked_o
);
  // Of the packets in a bin, for a cycle one more than are held; at least the bits of a turn and of n > 4.
  localparam int unsigned Bits = Packets > 6 ? $clog2(Packets + 2) : 3;

  // Operation 0 is the insertion, 1 the removal; so are the counts. Lowest bits and first index first.
  logic [1:0] ask1_q, ask2_q;
  logic [2*BinBits-1:0] bin1_q, bin2_q, bin3_q;
  logic [2*Bits-1:0] new2, new3_q, new4_q;  // own count once the operation is done
  logic [4*Bits-1:0] count2, count3_q;  // of operation o, count c at 2 * o + c, before the operation
  logic same1_q, same2_q, same3_q, same4_q;  // both are of one bin
  logic [2*Bits-1:0] held4_q;
  logic [1:0] few4;
  logic first5_q, linked5_q;

  assign {remove_bin_o, insert_bin_o} = bin3_q;
  assign insert_turn_o = count3_q[0+:2];
  assign remove_turn_o = count3_q[3*Bits+:2];
  assign first_o = first5_q;
  assign linked_o = linked5_q;

  always_ff @(posedge clk_i) begin
    ask1_q <= {remove_i, insert_i};
    ask2_q <= ask1_q;
    bin1_q <= {remove_bin_i, insert_bin_i};
    bin2_q <= bin1_q;
    bin3_q <= bin2_q;
    new3_q <= new2;
    new4_q <= new3_q;
    count3_q <= count2;
    same1_q <= insert_i && insert_bin_i == remove_bin_i;
    same2_q <= same1_q;
    same3_q <= same2_q;
    same4_q <= same3_q;
    for (int unsigned o = 0; o < 2; o++) begin
      held4_q[Bits*o+:Bits] <= count3_q[Bits*(2*o)+:Bits] - count3_q[Bits*(2*o+1)+:Bits];
    end
    // The removal's own difference lacks the insertion of its cycle.
    first5_q <= few4[0];
    linked5_q <= same4_q ? !few4[0] : !few4[1];
    if (rst_i) begin
      ask1_q <= '0;
      ask2_q <= '0;
    end
  end

  assign few4[0] = held4_q[0+:Bits] < Bits'(4);
  assign few4[1] = held4_q[Bits+:Bits] < Bits'(5);

  for (genvar o = 0; o < 2; o++) begin : gen_operation
    assign new2[Bits*o+:Bits] = count2[Bits*(2*o+o)+:Bits] + 1'b1;
    for (genvar c = 0; c < 2; c++) begin : gen_count
      logic [Bits-1:0] stored, stored_q;
      logic [1:0] unseen1_q, unseen2_q;  // by an operation of the cycle before; of the cycle before that

      block_ram #(
          .Width(Bits),
          .Depth(Bins)
      ) counts (
          .clk_i(clk_i),
          .write_i(clear_i || ask2_q[c]),
          .write_address_i(clear_i ? clear_bin_i : bin2_q[BinBits*c+:BinBits]),
          .write_data_i(clear_i ? '0 : new2[Bits*c+:Bits]),
          .read_i(1'b1),
          .read_address_i(o == 0 ? insert_bin_i : remove_bin_i),
          .read_data_o(stored)
      );

      always_ff @(posedge clk_i) begin
        stored_q <= stored;
        unseen1_q[0] <= ask1_q[c] && bin1_q[BinBits*c+:BinBits] == (o == 0 ? insert_bin_i : remove_bin_i);
        unseen1_q[1] <= ask2_q[c] && bin2_q[BinBits*c+:BinBits] == (o == 0 ? insert_bin_i : remove_bin_i);
        unseen2_q <= unseen1_q;
      end
      assign count2[Bits*(2*o+c)+:Bits] =
          unseen2_q[0] ? new3_q[Bits*c+:Bits] : unseen2_q[1] ? new4_q[Bits*c+:Bits] : stored_q;
    end
  end
endmodule
