// SPDX-License-Identifier: Apache-2.0
// Leaves of several compressed lines: what a line says of its leaf's next one is kept for its context. When the line is
// through and there is a next one, that is asked for, and the tree does not learn that the leaf is done. Tree t has the
// contexts c with c % Trees = t, as c / Trees.
//
// Combinational between its handshakes; of two trees' next lines that of tree 0 is asked for first.
module photon_gatherer_further_lines #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned AddressBits = photonloom_pkg::LineAddressBits
) (
    input  logic                             clk_i,
    // the last part of a line
    input  logic                             line_valid_i,
    input  logic [          ContextBits-1:0] line_context_i,
    input  logic                             line_more_i,       // its leaf has another one
    input  logic [            AddressBits:0] line_next_i,       // map, line
    // a line is through
    input  logic [                Trees-1:0] line_done_valid_i,
    output logic [                Trees-1:0] line_done_ready_o,
    input  logic [Trees*TreeContextBits-1:0] line_done_context_i,
    // and its leaf
    output logic [                Trees-1:0] leaf_done_valid_o,
    input  logic [                Trees-1:0] leaf_done_ready_i,
    // a next line
    output logic                             ask_valid_o,
    input  logic                             ask_ready_i,
    output logic [          ContextBits-1:0] ask_context_o,
    output logic [            AddressBits:0] ask_address_o
);
  logic [Trees-1:0] more, asks;
  logic [Trees*(AddressBits+1)-1:0] next;

  for (genvar tree = 0; tree < Trees; tree++) begin : gen_tree
    lut_ram #(
        .Width(AddressBits + 2),
        .Depth(TreeContexts)
    ) next_lines (
        .clk_i(clk_i),
        .write_i(line_valid_i && (32'(line_context_i) & (Trees - 1)) == tree),
        .write_address_i(TreeContextBits'(line_context_i >> $clog2(Trees))),
        .write_data_i({line_more_i, line_next_i}),
        .read_address_i(line_done_context_i[TreeContextBits*tree+:TreeContextBits]),
        .read_data_o({more[tree], next[(AddressBits+1)*tree+:AddressBits+1]})
    );
    if (tree == 0) begin : gen_first
      assign line_done_ready_o[tree] = more[tree] ? ask_ready_i : leaf_done_ready_i[tree];
    end else begin : gen_behind
      assign line_done_ready_o[tree] = more[tree] ? ask_ready_i && asks[tree-1:0] == '0 : leaf_done_ready_i[tree];
    end
    assign asks[tree] = line_done_valid_i[tree] && more[tree];
    assign leaf_done_valid_o[tree] = line_done_valid_i[tree] && !more[tree];
  end

  assign ask_valid_o = asks != '0;
  always_comb begin
    ask_context_o = '0;
    ask_address_o = '0;
    for (int unsigned tree = Trees; tree > 0; tree--) begin
      if (Trees == 1 || asks[tree-1]) begin
        ask_context_o = ContextBits'(32'(line_done_context_i[TreeContextBits*(tree-1)+:TreeContextBits]) * Trees + tree - 1);
        ask_address_o = next[(AddressBits+1)*(tree-1)+:AddressBits+1];
      end
    end
  end
endmodule
