// SPDX-License-Identifier: Apache-2.0
// In place of reorder_lists: ready at any time after reset and from then on; a packet comes out nine cycles after each removal.
// Two packets, x and y, which the harness chooses, come out when it is their turn in their bin, which is what is proved of the
// real one; all others come out as anything, which the harness may limit to what is neither x nor y.
module reorder_lists #(
    parameter int unsigned Width = 64,
    parameter int unsigned Packets = 2048,
    parameter int unsigned Bins = 512,
    parameter int unsigned BinBits = 9
) (
    input  logic               clk_i,
    input  logic               rst_i,
    output logic               ready_o,
    input  logic               insert_i,
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic [  Width-1:0] insert_packet_i,
    input  logic               remove_i,
    input  logic [BinBits-1:0] remove_bin_i,
    output logic               out_valid_o,
    output logic [  Width-1:0] out_o
);
  localparam int unsigned CountBits = $clog2(Packets + 2);
  (* anyseq *) logic ready;
  (* anyseq *) logic [Width-1:0] other;
  logic ready_q;
  (* keep *) logic [8:0] remove_q;  // bit n is cycle n + 1
  assign ready_o = ready_q;
  assign out_valid_o = remove_q[8];

  (* keep *) logic [(1<<BinBits)*CountBits-1:0] counts_q;  // packets of each bin
  for (genvar b = 0; b < (1 << BinBits); b++) begin : gen_bin
    always_ff @(posedge clk_i) begin
      counts_q[CountBits*b+:CountBits] <= counts_q[CountBits*b+:CountBits] +
          CountBits'(insert_i && insert_bin_i == BinBits'(b)) - CountBits'(remove_i && remove_bin_i == BinBits'(b));
      if (rst_i) counts_q[CountBits*b+:CountBits] <= '0;
    end
  end

  // Of x and y, in this order.
  (* anyseq *) logic [1:0] follow;  // the packet that is inserted is this one
  (* keep *) logic [1:0] held_q;  // it is in its bin
  (* keep *) logic [2*BinBits-1:0] bins_q;
  (* keep *) logic [2*CountBits-1:0] ahead_q;  // packets of its bin that leave before
  (* keep *) logic [17:0] leaves_q;  // bit n of nine is cycle n + 1 of its removal
  (* keep *) logic [2*Width-1:0] packets_q;
  assign out_o = leaves_q[8] ? packets_q[0+:Width] : leaves_q[17] ? packets_q[Width+:Width] : other;

  logic [CountBits-1:0] count;  // in the bin of the insertion
  assign count = counts_q[CountBits*insert_bin_i+:CountBits];
  for (genvar f = 0; f < 2; f++) begin : gen_followed
    logic enters, passed, leaves;
    logic [BinBits-1:0] bin;
    logic [CountBits-1:0] ahead;
    assign enters = insert_i && follow[f];
    assign bin = enters ? insert_bin_i : bins_q[BinBits*f+:BinBits];
    assign ahead = enters ? count : ahead_q[CountBits*f+:CountBits];
    assign passed = remove_i && remove_bin_i == bin;
    assign leaves = (enters || held_q[f]) && passed && ahead == '0;
    always_ff @(posedge clk_i) begin
      held_q[f] <= (enters || held_q[f]) && !leaves;
      bins_q[BinBits*f+:BinBits] <= bin;
      ahead_q[CountBits*f+:CountBits] <= ahead - CountBits'(passed);
      leaves_q[9*f+:9] <= {leaves_q[9*f+:8], leaves};
      if (enters) packets_q[Width*f+:Width] <= insert_packet_i;
      if (rst_i) begin
        held_q[f] <= 1'b0;
        leaves_q[9*f+:9] <= '0;
      end
    end
  end

  always_ff @(posedge clk_i) begin
    ready_q  <= ready_q || ready;
    remove_q <= {remove_q[7:0], remove_i};
    if (rst_i) begin
      ready_q  <= 1'b0;
      remove_q <= '0;
    end
  end
endmodule
