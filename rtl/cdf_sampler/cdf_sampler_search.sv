// SPDX-License-Identifier: Apache-2.0
// Inverts the prefix sums of two tables: the cell with F(c) <= t < F(c + 1), and its weight. A binary search with one
// memory a level, a level every two cycles: one search a cycle, latency 2 * IndexBits + 1, never stalls. F is written in
// order of cells; F(0) = 0 and F(cells) = W need no memory, and the bounds that are left at the end give the weight.
module cdf_sampler_search #(
    parameter int unsigned IndexBits = 8,  // of a cell
    parameter int unsigned TotalBits = 24
) (
    input  logic                 clk_i,
    input  logic                 write_i,
    input  logic                 write_table_i,
    input  logic [IndexBits-1:0] write_cell_i,
    input  logic [TotalBits-1:0] write_prefix_i,
    input  logic                 table_i,
    input  logic [TotalBits-1:0] t_i,
    input  logic [TotalBits-1:0] total_i,
    output logic [IndexBits-1:0] cell_o,
    output logic [TotalBits-1:0] weight_o
);
  // Before level l: l bits of the cell, the bounds, t and the table.
  logic [(IndexBits+1)*IndexBits-1:0] found;
  logic [(IndexBits+1)*TotalBits-1:0] lows, highs, ts;
  logic [IndexBits:0] tables;

  assign found[0+:IndexBits] = '0;
  assign lows[0+:TotalBits] = '0;
  assign highs[0+:TotalBits] = total_i;
  assign ts[0+:TotalBits] = t_i;
  assign tables[0] = table_i;

  for (genvar l = 0; l < IndexBits; l++) begin : gen_level
    // This level holds F of the cells that are odd multiples of 2^Rest.
    localparam int unsigned Rest = IndexBits - 1 - l;

    logic [IndexBits-1:0] cells, cells1_q, cells2_q;
    logic [TotalBits-1:0] middle, middle2_q, low1_q, high1_q, t1_q, low2_q, high2_q, t2_q;
    logic table1_q, table2_q, here, below;
    logic [l:0] address, write_address;

    assign cells = found[l*IndexBits+:IndexBits];
    assign here = write_i && (write_cell_i & IndexBits'((2 << Rest) - 1)) == IndexBits'(1 << Rest);
    if (l == 0) begin : gen_one
      assign address = tables[l];
      assign write_address = write_table_i;
    end else begin : gen_more
      assign address = {tables[l], cells[l-1:0]};
      assign write_address = {write_table_i, write_cell_i[IndexBits-1-:l]};
    end

    block_ram #(
        .Width(TotalBits),
        .Depth(2 << l)
    ) prefixes (
        .clk_i(clk_i),
        .write_i(here),
        .write_address_i(write_address),
        .write_data_i(write_prefix_i),
        .read_i(1'b1),
        .read_address_i(address),
        .read_data_o(middle)
    );

    always_ff @(posedge clk_i) begin
      cells1_q <= cells;
      low1_q <= lows[l*TotalBits+:TotalBits];
      high1_q <= highs[l*TotalBits+:TotalBits];
      t1_q <= ts[l*TotalBits+:TotalBits];
      table1_q <= tables[l];

      cells2_q <= cells1_q;
      low2_q <= low1_q;
      high2_q <= high1_q;
      t2_q <= t1_q;
      table2_q <= table1_q;
      middle2_q <= middle;
    end

    assign below = t2_q < middle2_q;
    assign found[(l+1)*IndexBits+:IndexBits] = IndexBits'({cells2_q, !below});
    assign lows[(l+1)*TotalBits+:TotalBits] = below ? low2_q : middle2_q;
    assign highs[(l+1)*TotalBits+:TotalBits] = below ? middle2_q : high2_q;
    assign ts[(l+1)*TotalBits+:TotalBits] = t2_q;
    assign tables[l+1] = table2_q;
  end

  logic unused;
  assign unused = &{1'b0, ts[IndexBits*TotalBits+:TotalBits], tables[IndexBits]};

  logic [TotalBits-1:0] low_q, high_q;
  always_ff @(posedge clk_i) begin
    cell_o <= found[IndexBits*IndexBits+:IndexBits];
    low_q  <= lows[IndexBits*TotalBits+:TotalBits];
    high_q <= highs[IndexBits*TotalBits+:TotalBits];
  end
  assign weight_o = high_q - low_q;
endmodule
