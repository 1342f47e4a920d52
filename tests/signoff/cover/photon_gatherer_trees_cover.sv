// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_trees_cover #(
    parameter int unsigned Trees
) (
    input logic clk_i,
    input logic rst_i,
    input logic hold_o,
    input logic held,
    input logic root,
    input logic [Trees-1:0] leaf_valid
);
  // Of several trees: a query that has started waits, for its tree goes on with another one.
  start_waits: cover property (@(posedge clk_i) disable iff (rst_i) Trees > 1 && hold_o && held);
  // Of several trees: a query enters its tree.
  start_goes_on: cover property (@(posedge clk_i) disable iff (rst_i) Trees > 1 && root);
  // Leaves of several trees come in one cycle.
  leaves_at_once: cover property (@(posedge clk_i) disable iff (rst_i) Trees > 1 && (leaf_valid & (leaf_valid - 1'b1)) != '0);
endmodule
