// SPDX-License-Identifier: Apache-2.0
// In place of free_list: hands out any numbers. That it hands out none that is out is for the harness to assume, which knows
// which are; the real one is proved by itself.
module free_list #(
    parameter int unsigned Count = 16,
    localparam int unsigned Bits = $clog2(Count)
) (
    input  logic            clk_i,
    input  logic            rst_i,
    input  logic            take_i,
    output logic [Bits-1:0] number_o,
    input  logic            give_i,
    input  logic [Bits-1:0] number_i
);
  (* anyseq *) logic [Bits-1:0] number;
  assign number_o = number;

  (* keep *) logic given;  // for probes
  (* keep *) logic [Bits-1:0] given_number;
  assign given = give_i;
  assign given_number = number_i;
endmodule
