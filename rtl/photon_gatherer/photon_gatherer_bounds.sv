// SPDX-License-Identifier: Apache-2.0
// The bounds of contexts, as one reader keeps them: written by all lists, read by context. List l of Lists has the
// contexts c with c % Lists = l, each as c / Lists. The reader is number Copy of Copies: it asks for the contexts c
// with c % Copies = Copy, as c / Copies, and only these are kept. LUT RAM, read combinationally; a bound can be read
// from the cycle after it is written. Powers of two both.
module photon_gatherer_bounds #(
    parameter int unsigned Contexts = 16,  // of the unit
    parameter int unsigned Lists = 1,
    parameter int unsigned Copies = 1,
    parameter int unsigned Copy = 0,
    parameter int unsigned R2Bits = 34,
    localparam int unsigned ListContexts = (Contexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned CopyContexts = (Contexts + Copies - 1) / Copies,
    localparam int unsigned CopyContextBits = CopyContexts > 1 ? $clog2(CopyContexts) : 1
) (
    input  logic                             clk_i,
    /* verilator lint_off UNUSEDSIGNAL */  // of the lists whose contexts the reader has not
    input  logic [                Lists-1:0] write_i,
    input  logic [Lists*ListContextBits-1:0] write_context_i,
    input  logic [         Lists*R2Bits-1:0] write_bound_i,
    /* verilator lint_on UNUSEDSIGNAL */
    input  logic [      CopyContextBits-1:0] read_context_i,
    output logic [               R2Bits-1:0] read_bound_o
);
  if (Lists >= Copies) begin : gen_lists
    // Of each list whose contexts are the reader's a memory.
    localparam int unsigned Banks = Lists / Copies;
    logic [Banks*R2Bits-1:0] words;
    for (genvar bank = 0; bank < Banks; bank++) begin : gen_bank
      localparam int unsigned List = Copies * bank + Copy;
      lut_ram #(
          .Width(R2Bits),
          .Depth(ListContexts)
      ) bound (
          .clk_i(clk_i),
          .write_i(write_i[List]),
          .write_address_i(write_context_i[ListContextBits*List+:ListContextBits]),
          .write_data_i(write_bound_i[R2Bits*List+:R2Bits]),
          .read_address_i(ListContextBits'(read_context_i >> $clog2(Banks))),
          .read_data_o(words[R2Bits*bank+:R2Bits])
      );
    end
    always_comb begin
      read_bound_o = words[0+:R2Bits];
      for (int unsigned i = 1; i < Banks; i++)
        if ((32'(read_context_i) & (Banks - 1)) == i) read_bound_o = words[R2Bits*i+:R2Bits];
    end
  end else begin : gen_part
    // Part of one list's contexts.
    localparam int unsigned Parts = Copies / Lists;
    localparam int unsigned List = Copy % Lists;
    logic [ListContextBits-1:0] context_written;
    assign context_written = write_context_i[ListContextBits*List+:ListContextBits];
    lut_ram #(
        .Width(R2Bits),
        .Depth(CopyContexts)
    ) bound (
        .clk_i(clk_i),
        .write_i(write_i[List] && (32'(context_written) & (Parts - 1)) == Copy / Lists),
        .write_address_i(CopyContextBits'(context_written >> $clog2(Parts))),
        .write_data_i(write_bound_i[R2Bits*List+:R2Bits]),
        .read_address_i(read_context_i),
        .read_data_o(read_bound_o)
    );
  end
endmodule
