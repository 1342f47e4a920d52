// SPDX-License-Identifier: Apache-2.0
// For harnesses with several clocks: a register takes its value in each step in which its clock signal is 1, so the signal
// says which steps are edges of that clock.
(* techmap_celltype = "$dff" *)
module clock_steps (
    CLK,
    D,
    Q
);
  parameter WIDTH = 1;
  parameter CLK_POLARITY = 1'b1;
  input CLK;
  input [WIDTH-1:0] D;
  output [WIDTH-1:0] Q;
  wire _TECHMAP_FAIL_ = !CLK_POLARITY;
  \$ff #(
      .WIDTH(WIDTH)
  ) _TECHMAP_REPLACE_ (
      .D(CLK ? D : Q),
      .Q(Q)
  );
endmodule
