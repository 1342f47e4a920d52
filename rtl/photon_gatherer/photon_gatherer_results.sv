// SPDX-License-Identifier: Apache-2.0
// Results leave in the order of their queries although queries finish in any. Every query takes a slot when it starts;
// its numbers are written when its sum is done, its reciprocal when that is; the head slot leaves when it is complete.
// There are Slots of them, more than contexts, so a slow query does not stop those behind it. A flush takes a slot and
// is complete at once. take_i holds one of the reciprocals' places for a query whose sum begins; of these modules there
// are as many as of sums, or more.
//
// What is written last has the lap of its slot beside it: how often, modulo 2, the slots had gone round when the query
// took it. A slot is complete iff it shows the lap of the head. A flush writes it when it starts, so it waits where
// another is written; of several sums, or Wide, where that is known late, its start does not wait, but that word and the next flush. After reset, which takes Slots cycles, all show the other lap. Starts are at least two cycles apart.
//
// Of one sum and far from block RAM (Far) what a query finished with is kept in halves (block_ram_halves): sums end at least two
// cycles apart, and the head slot stands longer than it takes.
//
// Latency from finish to output 3 cycles, with a reciprocal 3 more than that takes; one result each 3 cycles at best, of several
// sums, Wide and where results come from far a cycle more of each, in halves two.
module photon_gatherer_results #(
    parameter int unsigned Slots = 64,
    parameter int unsigned Sums = 1,
    parameter int unsigned Units = Sums,  // reciprocals at once, as many as sums or more
    parameter bit Wide = 1'b0,  // of several trees and lists
    // With reciprocals, what a query finished with is written a cycle later, long before its reciprocal, with which a result is complete.
    parameter bit BodyLater = 1'b0,
    // A start is told of a cycle late: a slot more stays free, and a flush is written when that is possible.
    parameter bit StartLater = 1'b0,
    parameter bit Far = photonloom_pkg::FarGatherers != 0,  // from block RAM
    // A result's words in two halves, where that takes fewer block RAMs.
    parameter bit Halves = Far && Sums == 1 && photonloom_pkg::ReciprocalBits != 0 && Slots > photonloom_pkg::LutRamWords && Slots <= 256,
    localparam int unsigned SlotBits = $clog2(Slots)
) (
    input  logic                                                            clk_i,
    input  logic                                                            rst_i,
    // a query starts
    output logic                                                            start_ready_o,
    output logic                                                            flush_ready_o,  // and a flush may
    input  logic                                                            start_i,
    input  logic                                                            start_flush_i,
    input  logic                                                            start_map_i,
    input  logic [                              photonloom_pkg::TagBits-1:0] start_tag_i,
    input  logic [                           photonloom_pkg::SampleBits-1:0] start_sample_i,
    input  logic [                            photonloom_pkg::PixelBits-1:0] start_pixel_i,
    output logic [                                              SlotBits:0] start_slot_o,   // lap, slot
    // its sum begins, in each of the sums, and is done, in one of them
    output logic                                                            take_ready_o,
    input  logic [                                                Sums-1:0] take_i,
    input  logic [                                       Sums*SlotBits-1:0] take_slot_i,
    input  logic [                                                Sums-1:0] take_faulty_i,  // its query met a wrong word
    input  logic                                                            finish_i,
    input  logic [                                              SlotBits:0] finish_slot_i,  // lap, slot
    input  logic [                           photonloom_pkg::CountBits-1:0] finish_count_i,
    input  logic [                              photonloom_pkg::R2Bits-1:0] finish_r2_i,
    input  logic [photonloom_pkg::Channels*photonloom_pkg::FluxBits-1:0] finish_flux_i,
    input  logic [                              photonloom_pkg::LineBits:0] finish_nodes_i,
    input  logic [                              photonloom_pkg::LineBits:0] finish_leaves_i,
    input  logic [                             photonloom_pkg::IndexBits:0] finish_insertions_i,
    // results
    output logic                                                            result_valid_o,
    input  logic                                                            result_ready_i,
    output photonloom_pkg::gather_result_t                                  result_o
);
  localparam int unsigned R2Bits = photonloom_pkg::R2Bits;
  localparam int unsigned CountBits = photonloom_pkg::CountBits;
  localparam int unsigned FluxBits = photonloom_pkg::Channels * photonloom_pkg::FluxBits;
  localparam int unsigned NodeBits = photonloom_pkg::LineBits + 1;
  localparam int unsigned InsertBits = photonloom_pkg::IndexBits + 1;
  localparam int unsigned HeadBits = photonloom_pkg::PixelBits + photonloom_pkg::SampleBits + photonloom_pkg::TagBits + 1;
  localparam int unsigned BodyBits = CountBits + R2Bits + FluxBits + 2 * NodeBits + InsertBits + 2;
  localparam bit FlushRows = Wide && Sums == 1;
  localparam bit HasReciprocal = photonloom_pkg::ReciprocalBits != 0;
  localparam logic [1:0] Wait = 2'd0, Look = 2'd1, Out = 2'd2;

  logic [SlotBits:0] head_q, tail_q;
  logic [1:0] state_q;
  logic [HeadBits-1:0] head_word;
  logic [BodyBits-1:0] body_word;
  logic flush_word, flush_q;
  logic ready_q, occupied_q, settled_q, sweeping_q, complete;
  logic [SlotBits-1:0] sweep_q;

  // Of what is written last: that it is, and where; the lap that it shows.
  logic done, done_write, done_slot_lap, done_lap, lap;
  logic [SlotBits-1:0] done_slot, done_address;
  logic flush_waits, flush_start, flush_now, settled, lap_seen;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic last_free;  // where StartLater: one slot is free, or as if it were
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  logic [SlotBits:0] flush_slot;

  assign start_ready_o = ready_q;
  assign flush_ready_o = ready_q && !flush_waits;
  assign start_slot_o = tail_q;
  assign done_write = done || sweeping_q || (flush_now && flush_start);
  assign done_address = sweeping_q ? sweep_q : done ? done_slot : flush_slot[SlotBits-1:0];
  assign done_lap = sweeping_q || (done ? done_slot_lap : flush_slot[SlotBits]);

  // ---- the word of a flush ----
  if (Sums > 1 || Wide || StartLater) begin : gen_flush_register
    logic due_q;
    logic [SlotBits:0] slot_q;
    always_ff @(posedge clk_i) begin
      if (!due_q) begin
        due_q  <= start_i && start_flush_i;
        slot_q <= tail_q;
      end else if (!done) begin
        due_q <= 1'b0;
      end
      if (rst_i) due_q <= 1'b0;
    end
    assign flush_waits = due_q;
    assign flush_start = due_q;
    assign flush_now = 1'b1;
    assign flush_slot = slot_q;
  end else begin : gen_flush
    assign flush_waits = done;
    assign flush_start = start_i;
    assign flush_now = start_flush_i;
    assign flush_slot = tail_q;
  end

  block_ram #(
      .Width(HeadBits),
      .Depth(Slots)
  ) heads (
      .clk_i(clk_i),
      .write_i(start_i),
      .write_address_i(tail_q[SlotBits-1:0]),
      .write_data_i({start_pixel_i, start_sample_i, start_tag_i, start_map_i}),
      .read_i(1'b1),
      .read_address_i(head_q[SlotBits-1:0]),
      .read_data_o(head_word)
  );

  // Whether a slot is a flush's clears most of a result: it comes from LUTs and a register, for block RAM would be late. Wide, with
  // one sum, it comes from block RAM and a register: the lap is looked at a cycle later there.
  if (FlushRows) begin : gen_flush_rows
    block_ram #(
        .Width(1),
        .Depth(Slots)
    ) flushes (
        .clk_i(clk_i),
        .write_i(start_i),
        .write_address_i(tail_q[SlotBits-1:0]),
        .write_data_i(start_flush_i),
        .read_i(1'b1),
        .read_address_i(head_q[SlotBits-1:0]),
        .read_data_o(flush_word)
    );
  end else begin : gen_flush_bits
    lut_ram #(
        .Width(1),
        .Depth(Slots)
    ) flushes (
        .clk_i(clk_i),
        .write_i(start_i),
        .write_address_i(tail_q[SlotBits-1:0]),
        .write_data_i(start_flush_i),
        .read_address_i(head_q[SlotBits-1:0]),
        .read_data_o(flush_word)
    );
  end
  always_ff @(posedge clk_i) flush_q <= flush_word;

  // ---- the head slot ----
  logic [photonloom_pkg::PixelBits-1:0] pixel;
  logic [photonloom_pkg::SampleBits-1:0] sample;
  logic [photonloom_pkg::TagBits-1:0] tag;
  logic map, full, clamped;
  logic [CountBits-1:0] count;
  logic [R2Bits-1:0] r2;
  logic [FluxBits-1:0] flux;
  logic [NodeBits-1:0] nodes, leaves;
  logic [InsertBits-1:0] insertions;
  photonloom_pkg::gather_result_t result;
  logic [BodyBits-1:0] finish_body;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  // where BodyLater
  logic later_q;
  logic [SlotBits-1:0] later_slot_q;
  logic [BodyBits-1:0] later_body_q;
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */

  assign {pixel, sample, tag, map} = head_word;
  assign {count, r2, flux, nodes, leaves, insertions, full, clamped} = flush_q ? '0 : body_word;
  assign finish_body = {
    finish_count_i,
    finish_r2_i,
    finish_flux_i,
    finish_nodes_i,
    finish_leaves_i,
    finish_insertions_i,
    finish_count_i == CountBits'(photonloom_pkg::K),
    finish_r2_i < photonloom_pkg::R2Floor
  };

  if (BodyLater) begin : gen_later
    always_ff @(posedge clk_i) begin
      later_q <= finish_i && !rst_i;
      later_slot_q <= finish_slot_i[SlotBits-1:0];
      later_body_q <= finish_body;
    end
  end

  if (HasReciprocal) begin : gen_reciprocal
    localparam int unsigned MantissaBits = photonloom_pkg::ReciprocalBits + 1;
    localparam int unsigned ExponentBits = photonloom_pkg::ReciprocalExponentBits;
    localparam int unsigned Places = Sums > 2 ? 4 * Sums : 8;
    localparam int unsigned PlacesBits = $clog2(Places + 1);
    localparam int unsigned UnitBits = SlotBits + 1 + MantissaBits + ExponentBits;
    logic [PlacesBits-1:0] places_q, taken;
    logic wait_valid;
    logic [Units-1:0] unit_ready, unit_done;
    /* verilator lint_off UNDRIVEN */
    /* verilator lint_off UNUSEDSIGNAL */
    logic [Units-1:0] takes;  // take_i, where there are more units than sums
    /* verilator lint_on UNUSEDSIGNAL */
    /* verilator lint_on UNDRIVEN */
    logic [Units*UnitBits-1:0] unit_words;
    logic [UnitBits-1:0] unit_word;
    logic [SlotBits:0] wait_slot;
    logic [R2Bits-1:0] wait_r2;
    logic [MantissaBits-1:0] mantissa;
    logic [ExponentBits-1:0] exponent;
    logic [MantissaBits+ExponentBits-1:0] word;
    /* verilator lint_off UNUSEDSIGNAL */  // a place was taken
    logic wait_ready;
    /* verilator lint_on UNUSEDSIGNAL */

    assign take_ready_o = places_q >= PlacesBits'(Sums);
    if (Units != Sums) begin : gen_takes
      assign takes = Units'(take_i);
    end

    fifo #(
        .Width(SlotBits + 1 + R2Bits),
        .Depth(Places)
    ) waiting (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(finish_i),
        .in_ready_o(wait_ready),
        .in_i({finish_slot_i, finish_r2_i < photonloom_pkg::R2Floor ? photonloom_pkg::R2Floor : finish_r2_i}),
        .out_valid_o(wait_valid),
        .out_ready_i(unit_ready != '0),
        .out_o({wait_slot, wait_r2})
    );

    // The first unit that is free takes the oldest; of those that are done the first gives its result.
    for (genvar u = 0; u < Units; u++) begin : gen_unit
      logic first_free, first_done;
      logic [SlotBits:0] slot_q;
      if (u == 0) begin : gen_first
        assign first_free = 1'b1;
        assign first_done = 1'b1;
      end else begin : gen_other
        assign first_free = unit_ready[u-1:0] == '0;
        assign first_done = unit_done[u-1:0] == '0;
      end
      reciprocal #(
          .XBits(R2Bits),
          .W(photonloom_pkg::ReciprocalBits)
      ) unit (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .in_valid_i(wait_valid && first_free),
          .in_ready_o(unit_ready[u]),
          .in_i(wait_r2),
          .out_valid_o(unit_done[u]),
          .out_ready_i(first_done),
          .mantissa_o(unit_words[UnitBits*u+ExponentBits+:MantissaBits]),
          .exponent_o(unit_words[UnitBits*u+:ExponentBits])
      );
      assign unit_words[UnitBits*u+ExponentBits+MantissaBits+:SlotBits+1] = slot_q;
      always_ff @(posedge clk_i) if (unit_ready[u]) slot_q <= wait_slot;
    end

    always_comb begin
      unit_word = unit_words[0+:UnitBits];
      taken = '0;
      for (int unsigned u = Units; u > 0; u--) begin
        if (unit_done[u-1]) unit_word = unit_words[UnitBits*(u-1)+:UnitBits];
        taken = taken + (Units == Sums ? PlacesBits'(take_i[u-1]) : PlacesBits'(takes[u-1]));
      end
    end

    if (Halves) begin : gen_halves
      block_ram_halves #(
          .Width(BodyBits),
          .Depth(Slots)
      ) bodies (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .write_i(finish_i),
          .write_address_i(finish_slot_i[SlotBits-1:0]),
          .write_data_i(finish_body),
          .read_address_i(head_q[SlotBits-1:0]),
          .read_data_o(body_word)
      );
    end else begin : gen_whole
      block_ram #(
          .Width(BodyBits),
          .Depth(Slots)
      ) bodies (
          .clk_i(clk_i),
          .write_i(BodyLater ? later_q : finish_i),
          .write_address_i(BodyLater ? later_slot_q : finish_slot_i[SlotBits-1:0]),
          .write_data_i(BodyLater ? later_body_q : finish_body),
          .read_i(1'b1),
          .read_address_i(head_q[SlotBits-1:0]),
          .read_data_o(body_word)
      );
    end

    block_ram #(
        .Width(1 + MantissaBits + ExponentBits),
        .Depth(Slots)
    ) reciprocals (
        .clk_i(clk_i),
        .write_i(done_write),
        .write_address_i(done_address),
        .write_data_i({done_lap, mantissa, exponent}),
        .read_i(1'b1),
        .read_address_i(head_q[SlotBits-1:0]),
        .read_data_o({lap, word})
    );

    always_ff @(posedge clk_i) begin
      places_q <= places_q - taken + PlacesBits'(done);
      if (rst_i) places_q <= PlacesBits'(Places);
    end

    assign done = unit_done != '0;
    assign {done_slot_lap, done_slot, mantissa, exponent} = unit_word;

    always_comb begin
      result.reciprocal = flush_q ? '0 : word[ExponentBits+:MantissaBits];
      result.reciprocal_exponent = flush_q ? '0 : word[ExponentBits-1:0];
    end
  end else begin : gen_no_reciprocal
    /* verilator lint_off UNUSEDSIGNAL */  // nothing to hold places for
    logic [Sums-1:0] take;
    /* verilator lint_on UNUSEDSIGNAL */
    assign take = take_i;
    assign take_ready_o = 1'b1;
    assign done = finish_i;
    assign {done_slot_lap, done_slot} = finish_slot_i;

    block_ram #(
        .Width(1 + BodyBits),
        .Depth(Slots)
    ) bodies (
        .clk_i(clk_i),
        .write_i(done_write),
        .write_address_i(done_address),
        .write_data_i({done_lap, finish_body}),
        .read_i(1'b1),
        .read_address_i(head_q[SlotBits-1:0]),
        .read_data_o({lap, body_word})
    );
  end

  // ---- slots whose queries met a wrong word ----
  if (photonloom_pkg::Parity != 0) begin : gen_faulty
    logic [Slots-1:0] faulty_q;
    always_ff @(posedge clk_i) begin
      if (start_i) faulty_q[tail_q[SlotBits-1:0]] <= 1'b0;
      for (int unsigned s = 0; s < Sums; s++)
        if (take_i[s] && take_faulty_i[s]) faulty_q[take_slot_i[SlotBits*s+:SlotBits]] <= 1'b1;
    end
    always_comb result.faulty = faulty_q[head_q[SlotBits-1:0]];
  end else begin : gen_no_faulty
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, take_slot_i, take_faulty_i};
  end

  always_comb begin
    result.pixel = pixel;
    result.sample = sample;
    result.tag = tag;
    result.map = map && !flush_q;
    result.flush = flush_q;
    result.count = count;
    result.r2 = r2;
    result.flux = flux;
    result.full = full;
    result.clamped = clamped;
    result.nodes = nodes;
    result.leaves = leaves;
    result.insertions = insertions;
  end

  assign result_valid_o = state_q == Out;
  assign complete = occupied_q && settled && lap_seen == head_q[SlotBits];

  // Of several sums, of several trees and lists, or of gatherers that lie far from their block RAM, the lap, which comes from there late, has a register and is
  // looked at a cycle later; where there are halves one more, for both to come.
  if (Sums > 1 || Wide || Far) begin : gen_lap_register
    logic lap_q, settled_2_q, look_q;
    /* verilator lint_off UNUSEDSIGNAL */  // of words that are whole
    /* verilator lint_off UNDRIVEN */
    logic halves_come, first_look_q;
    /* verilator lint_on UNDRIVEN */
    /* verilator lint_on UNUSEDSIGNAL */
    if (Halves) begin : gen_halves_come
      always_ff @(posedge clk_i) first_look_q <= state_q == Look;
      assign halves_come = first_look_q;
    end
    always_ff @(posedge clk_i) begin
      lap_q <= lap;
      settled_2_q <= settled_q;
      look_q <= state_q == Look && (!Halves || halves_come);
    end
    assign lap_seen = lap_q;
    assign settled = settled_2_q && look_q;
  end else begin : gen_lap
    assign lap_seen = lap;
    assign settled = settled_q;
  end

  if (StartLater) begin : gen_last_free
    logic [SlotBits:0] next;
    assign next = tail_q + 1'b1;
    assign last_free = next == {~head_q[SlotBits], head_q[SlotBits-1:0]};
  end

  always_ff @(posedge clk_i) begin
    unique case (state_q)
      Wait: state_q <= Look;
      Look: begin
        result_o <= result;
        if (complete) state_q <= Out;
      end
      default:
      if (result_ready_i) begin
        state_q <= Wait;
        head_q <= head_q + 1'b1;
      end
    endcase
    if (start_i) tail_q <= tail_q + 1'b1;
    ready_q <= !sweeping_q && tail_q != {~head_q[SlotBits], head_q[SlotBits-1:0]} && !(StartLater ? last_free : 1'b0);
    // What was written in the cycle before was not read.
    occupied_q <= tail_q != head_q;
    settled_q <= !(done_write && done_address == head_q[SlotBits-1:0]);
    if (sweeping_q) begin
      sweep_q <= sweep_q + 1'b1;
      sweeping_q <= sweep_q != SlotBits'(Slots - 1);
    end
    if (rst_i) begin
      state_q <= Wait;
      head_q <= '0;
      tail_q <= '0;
      ready_q <= 1'b0;
      sweeping_q <= 1'b1;
      sweep_q <= '0;
    end
  end
endmodule
