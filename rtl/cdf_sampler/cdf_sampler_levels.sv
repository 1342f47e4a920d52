// SPDX-License-Identifier: Apache-2.0
// Q(c), the power of a table's photons spread over cells and blocks of cells: the sum of 4^(Levels-1-l) P_l(c), P_l(c) being
// the power in the block of 2^l x 2^l cells that holds c; and TP, the sum over all cells. Exact. One photon a cycle; cells
// are read once each in the order of their numbers, Q comes 2 + ceil(log2 Levels) cycles after read_i, and a block is 0
// again when its last cell was read. While ready_o is 0 after reset the blocks are being cleared. A photon may be read 4
// cycles after it came. Mirrors add_levels of golden/unit/cdf_sampler.cpp.
module cdf_sampler_levels #(
    parameter int unsigned CellBits = 4,
    parameter int unsigned Levels = 1,  // at most CellBits + 1
    parameter int unsigned PowerBits = 42,  // of one photon
    parameter int unsigned FactorBits = 13,  // of one photon before the shift
    parameter int unsigned ShiftBits = 5,
    parameter int unsigned TotalBits = 48,  // of TP
    localparam int unsigned IndexBits = 2 * CellBits,
    localparam int unsigned SpreadBits = TotalBits + 2 * (Levels - 1) + $clog2(Levels)
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    output logic                  ready_o,
    input  logic                  start_i,       // TP is 0 again
    input  logic                  add_i,         // not while cells are read
    input  logic [ IndexBits-1:0] add_cell_i,
    input  logic [FactorBits-1:0] add_factor_i,  // times 2^add_shift_i is its power
    input  logic [ ShiftBits-1:0] add_shift_i,
    input  logic                  read_i,
    input  logic [ IndexBits-1:0] read_cell_i,
    output logic [SpreadBits-1:0] spread_o,
    output logic [ TotalBits-1:0] total_o        // 2 cycles after add_i
);
  // The blocks of a level, and what each adds to Q. A block of all cells is TP.
  localparam int unsigned Stages = $clog2(Levels);
  logic [(1<<Stages)*SpreadBits-1:0] terms;
  logic [Levels-1:0] readys;
  assign ready_o = readys[0];

  for (genvar l = 0; l < 1 << Stages; l++) begin : gen_level
    if (l >= Levels) begin : gen_none
      assign terms[l*SpreadBits+:SpreadBits] = '0;
    end else begin : gen_some
      localparam int unsigned Shift = 2 * (Levels - 1 - l);
      logic [TotalBits-1:0] power;
      assign terms[l*SpreadBits+:SpreadBits] = SpreadBits'(power) << Shift;
      if (l == CellBits) begin : gen_all
        assign power = total_o;
        assign readys[l] = 1'b1;
      end else begin : gen_blocks
        localparam int unsigned Side = CellBits - l;
        logic last;
        logic [TotalBits-1:0] total;
        if (l == 0) begin : gen_cells
          assign last = 1'b1;
          assign total_o = total;
        end else begin : gen_last
          assign last = &{read_cell_i[CellBits+:l], read_cell_i[0+:l]};
          logic unused;
          assign unused = &{1'b0, total};
        end
        cdf_sampler_power #(
            .IndexBits(2 * Side),
            .PowerBits(PowerBits),
            .FactorBits(FactorBits),
            .ShiftBits(ShiftBits),
            .TotalBits(TotalBits)
        ) blocks (
            .clk_i(clk_i),
            .rst_i(rst_i),
            .ready_o(readys[l]),
            .start_i(start_i),
            .add_i(add_i),
            .add_cell_i({add_cell_i[IndexBits-1-:Side], add_cell_i[CellBits-1-:Side]}),
            .add_factor_i(add_factor_i),
            .add_shift_i(add_shift_i),
            .read_i(read_i),
            .clear_i(last),
            .read_cell_i({read_cell_i[IndexBits-1-:Side], read_cell_i[CellBits-1-:Side]}),
            .power_o(power),
            .total_o(total)
        );
      end
    end
  end

  // Added up pair by pair, a cycle a level of the tree. Node i adds nodes 2i and 2i + 1; the terms are the leaves.
  logic [2*(1<<Stages)*SpreadBits-1:0] nodes;
  assign nodes[(1<<Stages)*SpreadBits+:(1<<Stages)*SpreadBits] = terms;
  assign nodes[0+:SpreadBits] = '0;
  for (genvar i = 1; i < 1 << Stages; i++) begin : gen_node
    logic [SpreadBits-1:0] sum_q;
    always_ff @(posedge clk_i)
      sum_q <= nodes[2*i*SpreadBits+:SpreadBits] + nodes[(2*i+1)*SpreadBits+:SpreadBits];
    assign nodes[i*SpreadBits+:SpreadBits] = sum_q;
  end
  assign spread_o = nodes[SpreadBits+:SpreadBits];
  logic unused;
  assign unused = &{1'b0, readys, nodes[0+:SpreadBits]};
endmodule
