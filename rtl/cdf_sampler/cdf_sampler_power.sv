// SPDX-License-Identifier: Apache-2.0
// P(c), the power of a table's photons by cell, and TP, their sum: exact. One photon a cycle; a cell that was read with
// clear_i is 0 again. While ready_o is 0 after reset the cells are being cleared. A photon may be read 4 cycles after it came.
module cdf_sampler_power #(
    parameter int unsigned IndexBits = 8,  // of a cell
    parameter int unsigned PowerBits = 42,  // of one photon
    parameter int unsigned FactorBits = 13,  // of one photon before the shift
    parameter int unsigned ShiftBits = 5,
    parameter int unsigned TotalBits = 48
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    output logic                 ready_o,
    input  logic                 start_i,      // TP is 0 again
    input  logic                 add_i,        // not while cells are read
    input  logic [IndexBits-1:0] add_cell_i,
    input  logic [FactorBits-1:0] add_factor_i,  // times 2^add_shift_i is its power
    input  logic [ShiftBits-1:0] add_shift_i,
    input  logic                 read_i,
    input  logic                 clear_i,      // with read_i
    input  logic [IndexBits-1:0] read_cell_i,
    output logic [TotalBits-1:0] power_o,      // 2 cycles after read_i
    output logic [TotalBits-1:0] total_o       // 2 cycles after add_i
);
  logic [IndexBits:0] walk_q;
  assign ready_o = walk_q[IndexBits];

  // Read, choose, add and write. A cell that was changed by the two photons before is taken from where it is.
  logic add1_q, add2_q, add3_q, clear1_q;
  logic [IndexBits-1:0] cell1_q, cell2_q, cell3_q, read_cell1_q;
  logic [PowerBits-1:0] power1_q, power2_q;
  logic [TotalBits-1:0] stored, base2_q, sum2, sum3_q;

  assign sum2 = base2_q + TotalBits'(power2_q);

  block_ram #(
      .Width(TotalBits),
      .Depth(1 << IndexBits)
  ) cells (
      .clk_i(clk_i),
      .write_i(!ready_o || add2_q || clear1_q),
      .write_address_i(!ready_o ? walk_q[IndexBits-1:0] : clear1_q ? read_cell1_q : cell2_q),
      .write_data_i(ready_o && !clear1_q ? sum2 : '0),
      .read_i(1'b1),
      .read_address_i(read_i ? read_cell_i : add_cell_i),
      .read_data_o(stored)
  );

  always_ff @(posedge clk_i) begin
    add1_q <= add_i;
    cell1_q <= add_cell_i;
    power1_q <= PowerBits'(add_factor_i) << add_shift_i;

    add2_q <= add1_q;
    cell2_q <= cell1_q;
    power2_q <= power1_q;
    base2_q <= add2_q && cell2_q == cell1_q ? sum2 : add3_q && cell3_q == cell1_q ? sum3_q : stored;

    add3_q <= add2_q;
    cell3_q <= cell2_q;
    sum3_q <= sum2;

    clear1_q <= read_i && clear_i;
    read_cell1_q <= read_cell_i;
    power_o <= stored;

    if (add1_q) total_o <= total_o + TotalBits'(power1_q);
    if (!ready_o) walk_q <= walk_q + 1'b1;
    if (start_i) total_o <= '0;
    if (rst_i) begin
      walk_q <= '0;
      add1_q <= 1'b0;
      add2_q <= 1'b0;
      add3_q <= 1'b0;
      clear1_q <= 1'b0;
    end
  end
endmodule
