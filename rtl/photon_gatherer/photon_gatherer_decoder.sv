// SPDX-License-Identifier: Apache-2.0
// Parts of compressed lines, Lanes records each and the line's header, to photons as plain lines have them, but for their
// positions, which stay relative to the line's corner: who measures distances takes the corner off the query's position once.
// A record's four shared bits belong to the fields that the header's split says, its three offsets to the axes that the
// header's axis says; the header's exponent is added. Format: docs/photon_memory.md. Mirrors read_leaf in
// golden/unit/photon_lines.cpp.
//
// Latency 1; one part a cycle.
module photon_gatherer_decoder #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Lanes = 4,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned Bucket = photonloom_pkg::Bucket,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1,
    localparam int unsigned AddressBits = photonloom_pkg::LineAddressBits,
    localparam int unsigned PositionBits = photonloom_pkg::PositionBits,
    localparam int unsigned RecordBits = photonloom_pkg::RecordBits,
    localparam int unsigned HeaderBits = Bucket * photonloom_pkg::SlotHeaderBits,
    localparam int unsigned PhotonBits = photonloom_pkg::PhotonBits
) (
    input  logic                        clk_i,
    input  logic                        rst_i,
    // parts of lines
    input  logic                        in_valid_i,
    input  logic [     ContextBits-1:0] in_context_i,
    input  logic [        BeatBits-1:0] in_beat_i,
    input  logic [Lanes*RecordBits-1:0] in_records_i,
    input  logic [      HeaderBits-1:0] in_header_i,
    // photons
    output logic                        out_valid_o,
    output logic [     ContextBits-1:0] out_context_o,
    output logic [        BeatBits-1:0] out_beat_o,
    output logic [           Lanes-1:0] out_used_o,
    output logic [Lanes*PhotonBits-1:0] out_photons_o,
    output logic [  3*PositionBits-1:0] out_corner_o,
    // beside the last part of a line: whether its leaf has another one
    output logic                        out_last_o,
    output logic                        out_more_o,
    output logic [       AddressBits:0] out_next_o      // map, line
);
  localparam int unsigned P = PositionBits;
  localparam int unsigned A = photonloom_pkg::AxisOffsetBits;
  localparam int unsigned B = photonloom_pkg::OtherOffsetBits;
  localparam int unsigned CornerBits = photonloom_pkg::CornerBits;
  localparam int unsigned StepBits = P - CornerBits;
  localparam int unsigned ExponentBits = photonloom_pkg::ExponentBits;
  localparam int unsigned MantissasBits = photonloom_pkg::Channels * photonloom_pkg::MantissaBits;
  localparam int unsigned DirectionsBits = 2 * photonloom_pkg::DirectionBits;
  localparam int unsigned SharedAt = 2 * B + A;
  localparam int unsigned DirectionsAt = SharedAt + 4;
  localparam int unsigned ExponentAt = DirectionsAt + DirectionsBits;
  localparam int unsigned MantissasAt = ExponentAt + 2;

  if (MantissasAt + MantissasBits != RecordBits) begin : gen_bad_record
    record_bits_must_be_those_of_its_fields bad_record ();
  end

  logic [Lanes*RecordBits-1:0] records_q;
  /* verilator lint_off UNUSEDSIGNAL */  // its last slots may have more room than is needed
  logic [HeaderBits-1:0] header_q;
  /* verilator lint_on UNUSEDSIGNAL */

  always_ff @(posedge clk_i) begin
    out_valid_o <= in_valid_i;
    out_context_o <= in_context_i;
    out_beat_o <= in_beat_i;
    records_q <= in_records_i;
    header_q <= in_header_i;
    if (rst_i) out_valid_o <= 1'b0;
  end

  // ---- the header ----
  logic [1:0] split, axis;
  logic even;
  logic [ExponentBits-1:0] exponent;
  logic [3*CornerBits-1:0] corner;

  assign {corner, exponent, out_more_o, axis, split} = header_q[0+:5+ExponentBits+3*CornerBits];
  assign even = axis == 2'd3;
  assign out_last_o = out_valid_o && out_beat_o == BeatBits'(Beats - 1);
  assign out_next_o = records_q[RecordBits*(Lanes-1)+:AddressBits+1];
  for (genvar c = 0; c < 3; c++) begin : gen_corner
    assign out_corner_o[P*c+:P] = P'(corner[CornerBits*c+:CornerBits]) << StepBits;
  end

  // ---- records ----
  for (genvar lane = 0; lane < Lanes; lane++) begin : gen_lane
    logic [RecordBits-1:0] record;
    logic [3:0] shared;
    /* verilator lint_off UNUSEDSIGNAL */  // exponents may be shorter
    logic [3:0] more_exponent;
    /* verilator lint_on UNUSEDSIGNAL */
    logic [MantissasBits-1:0] mantissas;
    /* verilator lint_off UNUSEDSIGNAL */  // an offset has no more bits than a coordinate
    logic [B+1:0] first, second;
    logic [A+3:0] own;
    /* verilator lint_on UNUSEDSIGNAL */
    logic [3*P-1:0] offsets;

    assign record = records_q[RecordBits*lane+:RecordBits];
    assign shared = record[SharedAt+:4];
    assign mantissas = record[MantissasAt+:MantissasBits];
    assign out_used_o[lane] = record[ExponentAt+:2] != 2'd3 || mantissas != '0;

    always_comb begin
      first = (B + 2)'(record[0+:B]);
      second = (B + 2)'(record[B+:B]);
      own = (A + 4)'(record[2*B+:A]);
      more_exponent = 4'(record[ExponentAt+:2]);
      if (even) begin
        own[A+:3] = shared[2:0];
        if (split == 2'd1) first[B] = shared[3];
        else if (split == 2'd2) second[B] = shared[3];
        else own[A+3] = shared[3];
      end else begin
        if (split == 2'd0) own[A+:3] = shared[2:0];
        if (split == 2'd1) own[A] = shared[0];
        if (split == 2'd2) more_exponent[3] = shared[0];
        if (split != 2'd3) more_exponent[2] = shared[3];
        if (split == 2'd3) first[B+1] = shared[0];
        if (split == 2'd3) second[B+1] = shared[3];
        if (split != 2'd0) first[B] = shared[1];
        if (split != 2'd0) second[B] = shared[2];
      end
    end

    assign offsets[0+:P] = axis == 2'd0 ? P'(own) : P'(first);
    assign offsets[P+:P] = axis == 2'd1 ? P'(own) : axis == 2'd0 ? P'(first) : P'(second);
    assign offsets[2*P+:P] = axis[1] ? P'(own) : P'(second);

    assign out_photons_o[PhotonBits*lane+:PhotonBits] = {
      exponent + ExponentBits'(more_exponent), mantissas, record[DirectionsAt+:DirectionsBits], offsets
    };
  end
endmodule
