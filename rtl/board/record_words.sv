// SPDX-License-Identifier: Apache-2.0
// The output stream of docs/host-link.md: results and photons become records of words, which stay in block RAM until the
// host has said that it needs them no more; when the RAM is full results and photons wait. Of a result and a photon that
// both wait the kind that did not come last goes first, so neither waits for more than one record of the other.
//
// position_i: where it lies is in before_o, after_o and word_o 3 cycles later; keep_valid_i forgets the words before it.
// discard_i takes results and photons and keeps nothing; clear_i, while discard_i is 1, starts again at position 0.
// Throughput: a word a cycle.
module record_words #(
    parameter int unsigned Depth = 1024  // words kept
) (
    input  logic                                   clk_i,
    input  logic                                   rst_i,
    input  logic                                   clear_i,
    input  logic                                   discard_i,
    input  logic                                   result_valid_i,
    output logic                                   result_ready_o,
    input  photonloom_pkg::gather_result_t         result_i,
    input  logic                                   photon_valid_i,
    output logic                                   photon_ready_o,
    input  photonloom_pkg::gather_photon_t         photon_i,
    input  logic                           [31:0]  position_i,
    input  logic                                   keep_valid_i,
    output logic                                   before_o,
    output logic                                   after_o,
    output logic                           [31:0]  word_o,
    output logic                           [31:0]  first_o,
    output logic                           [31:0]  end_o
);
  localparam int unsigned AddressBits = $clog2(Depth);
  localparam int unsigned ResultBits = photonloom_pkg::GatherResultPacketBits;
  localparam int unsigned PhotonBits = photonloom_pkg::GatherPhotonPacketBits;
  localparam int unsigned ResultWords = (ResultBits + 31) / 32;
  localparam int unsigned PhotonWords = (PhotonBits + 31) / 32;
  localparam int unsigned MostWords = ResultWords > PhotonWords ? ResultWords : PhotonWords;

  if (Depth < 2 * (MostWords + 1) || (1 << AddressBits) != Depth) begin : gen_bad_depth
    record_words_depth_must_be_a_power_of_two_and_hold_two_records bad_depth ();
  end

  // ---- records, word by word: the packet stays offered until its last word is written ----
  // The word to come is selected by a shift register of one bit, which takes less logic than an index.
  logic active_q, photon_q, choose_photon, write_q, last, full_q;
  logic [ResultWords-1:0] result_at_q;
  logic [PhotonWords-1:0] photon_at_q;
  logic [32*ResultWords-1:0] result_bits;
  logic [32*PhotonWords-1:0] photon_bits;
  logic [31:0] word, word_q;

  assign result_bits = (32 * ResultWords)'(result_i);
  assign photon_bits = (32 * PhotonWords)'(photon_i);
  always_comb begin
    word = '0;
    for (int unsigned i = 0; i < ResultWords; i++) if (result_at_q[i]) word = word | result_bits[32*i+:32];
    for (int unsigned i = 0; i < PhotonWords; i++) if (photon_at_q[i]) word = word | photon_bits[32*i+:32];
  end

  assign choose_photon = photon_valid_i && (!result_valid_i || !photon_q);
  assign last = active_q && !full_q && (result_at_q[ResultWords-1] || photon_at_q[PhotonWords-1]);
  assign result_ready_o = discard_i || (last && !photon_q);
  assign photon_ready_o = discard_i || (last && photon_q);

  always_ff @(posedge clk_i) begin
    write_q <= 1'b0;
    if (!active_q) begin
      word_q <= 32'(choose_photon);
      result_at_q <= '0;
      photon_at_q <= '0;
      result_at_q[0] <= !choose_photon;
      photon_at_q[0] <= choose_photon;
      if ((result_valid_i || photon_valid_i) && !full_q) begin
        active_q <= 1'b1;
        photon_q <= choose_photon;
        write_q  <= 1'b1;
      end
    end else if (!full_q) begin
      word_q <= word;
      write_q <= 1'b1;
      result_at_q <= result_at_q << 1;
      photon_at_q <= photon_at_q << 1;
      if (last) active_q <= 1'b0;
    end
    if (rst_i || discard_i) begin
      active_q <= 1'b0;
      write_q  <= 1'b0;
    end
    if (rst_i) photon_q <= 1'b0;
  end

  // ---- the words kept: never as many as fit, so no word that is kept is read while its place is written ----
  logic [31:0] first_q, end_q, stored;
  logic [AddressBits:0] kept_q;

  block_ram #(
      .Width(32),
      .Depth(Depth)
  ) words (
      .clk_i(clk_i),
      .write_i(write_q),
      .write_address_i(end_q[AddressBits-1:0]),
      .write_data_i(word_q),
      .read_i(1'b1),
      .read_address_i(position_i[AddressBits-1:0]),
      .read_data_o(stored)
  );
  assign first_o = first_q;
  assign end_o   = end_q;

  always_ff @(posedge clk_i) begin
    if (write_q) end_q <= end_q + 32'd1;
    if (keep_valid_i) first_q <= position_i;
    // Late by the words that were on their way: a few places stay empty.
    kept_q <= (AddressBits + 1)'(end_q - first_q);
    full_q <= kept_q >= (AddressBits + 1)'(Depth - 4);
    before_o <= signed'(position_i - first_q) < 0;
    after_o <= signed'(end_q - position_i) < 0;
    word_o <= stored;
    if (rst_i || clear_i) begin
      first_q <= '0;
      end_q   <= '0;
      kept_q  <= '0;
      full_q  <= 1'b0;
    end
  end
endmodule
