// SPDX-License-Identifier: Apache-2.0
// Bin of a position: the top bits of the Hilbert index of its cell, or of a multiplicative hash of it. One a cycle, never
// stalls; latency CellBits cycles (Hilbert) or 3 (hash). Mirrors reorder_bin of golden/unit/reorder_buffer.hpp.
module reorder_key #(
    parameter int unsigned Key = photonloom_pkg::ReorderKey,  // 1 Hilbert, 2 hash
    parameter int unsigned PositionBits = 16,
    parameter int unsigned CellBits = 3,
    parameter int unsigned Bins = 512,
    parameter int unsigned BinBits = 9  // of bin_o, at least log2(Bins)
) (
    input  logic                      clk_i,
    input  logic [3*PositionBits-1:0] position_i,  // z, y, x from the top
    output logic [       BinBits-1:0] bin_o
);
  localparam int unsigned KeyBits = $clog2(Bins);

  logic [3*CellBits-1:0] coarse;
  for (genvar c = 0; c < 3; c++) begin : gen_cell
    assign coarse[CellBits*c+:CellBits] = position_i[PositionBits*(c+1)-1-:CellBits];
    if (PositionBits > CellBits) begin : gen_rest
      logic unused;
      assign unused = &{1'b0, position_i[PositionBits*c+:PositionBits-CellBits]};
    end
  end

  if (Key == 2) begin : gen_hash
    // floor(2^32 / golden ratio), Knuth's multiplicative hashing.
    localparam logic [31:0] Multiplier = 32'd2654435769;
    logic [3*CellBits-1:0] coarse_q;
    logic [31:0] product_q, hash_q;
    always_ff @(posedge clk_i) begin
      coarse_q  <= coarse;
      product_q <= 32'(coarse_q) * Multiplier;
      hash_q    <= product_q;
    end
    if (KeyBits == 0) begin : gen_one_bin
      logic unused;
      assign unused = &{1'b0, hash_q};
      assign bin_o = '0;
    end else begin : gen_bins
      logic unused;
      assign unused = &{1'b0, hash_q[31-KeyBits:0]};
      assign bin_o = BinBits'(hash_q[31-:KeyBits]);
    end
  end else begin : gen_hilbert
    logic [3*CellBits-1:0] index;
    hilbert_index #(
        .Bits(CellBits)
    ) curve (
        .clk_i(clk_i),
        .cell_i(coarse),
        .index_o(index)
    );
    assign bin_o = BinBits'(index >> (3 * CellBits - KeyBits));
  end
endmodule
