// SPDX-License-Identifier: Apache-2.0
module cdf_sampler_draw_cover #(
    parameter int unsigned CreditBits,
    parameter int unsigned TotalBits,
    parameter int unsigned IndexBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_ready_o,
    input logic head_valid,
    input logic head_table,
    input logic issue,
    input logic [1:0] finished_i,
    input logic [CreditBits-1:0] credit_q,
    input logic [3:0] tables_q,
    input logic [TotalBits-1:0] t,
    input logic [TotalBits-1:0] total4,
    input logic write_i,
    input logic out_taken,
    input logic found,
    input logic [IndexBits-1:0] found_cell
);
  logic issued_q;
  always_ff @(posedge clk_i) issued_q <= issue && !rst_i;

  // A request waits until its table is made.
  waits_for_table: cover property (@(posedge clk_i) disable iff (rst_i) head_valid && !finished_i[head_table]);
  // A request waits until there is room for its sample: nothing behind it stalls.
  no_credit: cover property (@(posedge clk_i) disable iff (rst_i) head_valid && finished_i[head_table] && credit_q == '0);
  // The last credit is taken as a sample leaves.
  last_credit_exchanged: cover property (@(posedge clk_i) disable iff (rst_i) credit_q == CreditBits'(1) && issue && out_taken);
  // Requests of both tables follow each other through the search.
  tables_follow: cover property (@(posedge clk_i) disable iff (rst_i) issued_q && tables_q[0] != tables_q[1]);
  // A request comes as one goes on its way.
  both_move: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && in_ready_o && issue);
  // One table is searched while the other one is written.
  searched_while_written: cover property (@(posedge clk_i) disable iff (rst_i) write_i && found);
  // The least place in a table.
  first_place: cover property (@(posedge clk_i) disable iff (rst_i) found && t == '0);
  // The greatest place in a table.
  last_place: cover property (@(posedge clk_i) disable iff (rst_i) found && t + TotalBits'(1) == total4);
  // The first cell is drawn: all searches went down.
  first_cell: cover property (@(posedge clk_i) disable iff (rst_i) found && found_cell == '0);
  // The last cell is drawn: all searches went up.
  last_cell: cover property (@(posedge clk_i) disable iff (rst_i) found && found_cell == '1);
endmodule
