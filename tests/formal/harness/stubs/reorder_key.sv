// SPDX-License-Identifier: Apache-2.0
// In place of reorder_key: any bins.
module reorder_key #(
    parameter int unsigned Key = 1,
    parameter int unsigned PositionBits = 16,
    parameter int unsigned CellBits = 3,
    parameter int unsigned Bins = 512,
    parameter int unsigned BinBits = 9
) (
    input  logic                      clk_i,
    input  logic [3*PositionBits-1:0] position_i,
    output logic [       BinBits-1:0] bin_o
);
  (* anyseq *) logic [BinBits-1:0] bin;
  assign bin_o = bin;
endmodule
