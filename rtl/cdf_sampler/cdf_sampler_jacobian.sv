// SPDX-License-Identifier: Apache-2.0
// floor(28 * 16^a / |o|^4) of a cell's centre o, 28 to 252; a table by |column| and |row| in a quadrant, 0 next to the
// axes. Combinational. Mirrors cell_jacobian of golden/unit/cdf_sampler.hpp.
module cdf_sampler_jacobian #(
    parameter int unsigned CellBits = 4,
    localparam int unsigned IndexBits = CellBits > 1 ? CellBits - 1 : 1
) (
    input  logic [IndexBits-1:0] column_i,
    input  logic [IndexBits-1:0] row_i,
    output logic [          7:0] jacobian_o
);
  localparam int unsigned Half = 1 << (CellBits - 1);

  function automatic [8*Half*Half-1:0] make_table(input integer unused);
    integer row, column, x, y, z, r2;
    begin
      make_table = '0;
      for (row = 0; row < Half; row = row + 1) begin
        for (column = 0; column < Half; column = column + 1) begin
          // Below the horizon of the octahedron a centre is the mirror image of one above.
          x  = 2 * column + 1 + 0 * unused;
          y  = 2 * row + 1;
          z  = 2 * Half - x - y;
          r2 = z < 0 ? (2 * Half - y) * (2 * Half - y) + (2 * Half - x) * (2 * Half - x) + z * z :
              x * x + y * y + z * z;
          make_table[8*(row*Half+column)+:8] = 8'((28 << (4 * CellBits)) / (r2 * r2));
        end
      end
    end
  endfunction

  localparam logic [8*Half*Half-1:0] Table = make_table(0);

  if (CellBits > 1) begin : gen_table
    assign jacobian_o = Table[8*{row_i, column_i}+:8];
  end else begin : gen_one
    logic unused;
    assign unused = &{1'b0, row_i, column_i};
    assign jacobian_o = Table;
  end
endmodule
