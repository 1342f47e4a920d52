// SPDX-License-Identifier: Apache-2.0
// Carries out the frames of docs/host-link.md, one at a time: reads a frame's bytes, reads and writes words, pushes and
// pulls, and gives the bytes of the answer. A few cycles a byte; only a write that write_ready_i keeps waiting takes
// longer. Where an address or a position is needed outside, address_o holds it for at least 4 cycles.
module link_commands (
    input  logic        clk_i,
    input  logic        rst_i,
    // a frame
    input  logic        frame_valid_i,
    input  logic        frame_bad_i,
    input  logic [ 8:0] frame_bytes_i,    // id to CRC
    output logic        frame_done_o,
    output logic        frame_bad_o,      // one cycle: it was answered with BAD
    output logic [ 8:0] read_address_o,
    input  logic [ 7:0] read_data_i,      // 2 cycles later
    // its answer
    output logic        answer_valid_o,
    input  logic        answer_ready_i,
    output logic [ 7:0] answer_o,
    output logic        answer_last_o,
    // a word of the address space or a position of a stream; what follows from it is taken 4 cycles later
    output logic [31:0] address_o,
    output logic        first_o,          // it is the first word of its READ or WRITE
    output logic        read_valid_o,     // one cycle: read_word_i is taken
    input  logic [31:0] read_word_i,
    output logic        write_valid_o,
    input  logic        write_ready_i,
    input  logic [ 1:0] write_status_i,   // with write_ready_i: 0, 1 or 2 of the specification
    output logic [31:0] write_word_o,
    output logic        write_last_o,     // the last word of its WRITE
    // input stream
    output logic        push_valid_o,     // where there is no room the position stays, and nothing more of this PUSH comes
    output logic [31:0] push_word_o,
    input  logic [31:0] push_position_i,
    input  logic [15:0] push_room_i,
    // output stream
    output logic        keep_valid_o,     // words before address_o may be forgotten
    input  logic        pull_before_i,    // address_o is before what is kept
    input  logic        pull_after_i,     // address_o is after the end
    input  logic [31:0] pull_first_i,
    input  logic [31:0] pull_end_i,
    input  logic [31:0] pull_word_i       // at address_o
);
  localparam logic [7:0] Read = 8'h01;
  localparam logic [7:0] Write = 8'h02;
  localparam logic [7:0] Push = 8'h03;
  localparam logic [7:0] Pull = 8'h04;

  typedef enum logic [4:0] {
    Idle,
    Get,      // left_q bytes from at_q on into word_q, then then_q
    GetByte,
    Load,     // the word of source_q into word_q, sent, then then_q
    Send,
    Command,
    Check,
    Count,    // READ, PULL: n
    Keep,     // PULL
    Kept,
    Address,
    Locate,   // PULL
    Next,     // WRITE, PUSH: word by word
    Store,
    Answer,   // its id and command
    Body,     // and the rest
    Room,     // PUSH: after the position
    Until,    // PULL: after the position
    Fetch,    // READ, PULL: word by word
    Done
  } state_t;

  // Where the word to send comes from: one bit a source.
  typedef struct packed {logic header, status, next, room, position, first, last, read, pull;} source_t;

  state_t state_q, then_q;
  source_t source_q;
  logic [7:0] id_q, command_q;
  logic [31:0] word_q, address_q, load;
  logic [8:0] at_q;
  logic [6:0] count_q;  // words that follow
  logic [2:0] left_q;
  logic [1:0] wait_q, status_q;
  logic bad_q, more_q, first_q, at_next_q;
  logic is_read, is_write, is_push, is_pull, body_good, count_good;
  logic [15:0] pull_left;

  assign is_read = command_q == Read;
  assign is_write = command_q == Write;
  assign is_push = command_q == Push;
  assign is_pull = command_q == Pull;

  // Bytes of a frame: 6 for id, command and CRC, and the body.
  always_comb begin
    if (is_read) body_good = frame_bytes_i == 9'd11;
    else if (is_pull) body_good = frame_bytes_i == 9'd15;
    else
      body_good = (is_write || is_push) && frame_bytes_i[1:0] == 2'd2 && frame_bytes_i >= 9'd14 &&
          frame_bytes_i <= 9'd266;
  end
  assign count_good = word_q[31:24] != 8'd0 && word_q[31:24] <= 8'd64;
  assign pull_left = 16'(pull_end_i - address_q);  // where address_q is a word that is kept, or the end

  // Selects are registers and gate what they select, which takes half the logic of a multiplexer.
  always_comb begin
    load = '0;
    if (source_q.header) load = load | {16'd0, bad_q ? 16'hFF00 : {8'h80 | command_q, id_q}};
    if (source_q.status) load = load | 32'(status_q);
    if (source_q.next) load = load | push_position_i;
    if (source_q.room) load = load | 32'(push_room_i);
    if (source_q.position) load = load | address_q;
    if (source_q.first) load = load | pull_first_i;
    if (source_q.last) load = load | pull_end_i;
    if (source_q.read) load = load | read_word_i;
    if (source_q.pull) load = load | pull_word_i;
  end

  assign frame_done_o = state_q == Done;
  assign frame_bad_o = state_q == Done && bad_q;
  assign read_address_o = at_q;
  assign address_o = address_q;
  assign write_word_o = word_q;
  assign first_o = first_q;
  assign read_valid_o = state_q == Load && source_q.read && wait_q == 2'd3;
  assign write_last_o = count_q == 7'd1;
  assign push_word_o = word_q;
  assign write_valid_o = state_q == Store && is_write;
  assign push_valid_o = state_q == Store && is_push && at_next_q;
  assign answer_valid_o = state_q == Send;
  assign answer_o = word_q[7:0];
  assign answer_last_o = left_q == 3'd1 && count_q == 7'd0 && !more_q;

  always_ff @(posedge clk_i) begin
    keep_valid_o <= 1'b0;
    // The position is older than the word that is in hand.
    at_next_q <= address_q == push_position_i;
    unique case (state_q)
      Idle: begin
        at_q <= '0;
        left_q <= 3'd2;
        then_q <= Command;
        wait_q <= '0;
        count_q <= '0;
        status_q <= '0;
        first_q <= 1'b1;
        bad_q <= frame_bad_i;
        if (frame_valid_i) state_q <= frame_bad_i ? Answer : Get;
      end

      Get: begin
        wait_q <= wait_q + 2'd1;
        if (wait_q == 2'd2) state_q <= GetByte;
      end
      GetByte: begin
        wait_q <= '0;
        word_q <= {read_data_i, word_q[31:8]};
        at_q <= at_q + 9'd1;
        left_q <= left_q - 3'd1;
        state_q <= left_q == 3'd1 ? then_q : Get;
      end
      Load: begin
        wait_q <= wait_q + 2'd1;
        word_q <= load;
        left_q <= source_q.header ? 3'd2 : 3'd4;
        if (wait_q == 2'd3) begin
          state_q <= Send;
          // As many as there are up to the end that is sent.
          if (source_q.last && !more_q && pull_left < 16'(count_q)) count_q <= pull_left[6:0];
          if (source_q.read || source_q.pull) begin
            address_q <= address_q + 32'd1;
            count_q   <= count_q - 7'd1;
            first_q   <= 1'b0;
          end
        end
      end
      Send:
      if (answer_ready_i) begin
        word_q <= {read_data_i, word_q[31:8]};
        left_q <= left_q - 3'd1;
        if (left_q == 3'd1) state_q <= then_q;
      end

      Command: begin
        {command_q, id_q} <= word_q[31:16];
        state_q <= Check;
      end
      Check: begin
        bad_q   <= !body_good;
        left_q  <= is_read || is_pull ? 3'd1 : 3'd4;
        at_q    <= is_read || is_pull ? 9'd6 : 9'd2;
        then_q  <= is_read || is_pull ? Count : Address;
        state_q <= body_good ? Get : Answer;
      end
      Count: begin
        bad_q  <= !count_good;
        left_q <= 3'd4;
        if (!is_pull) at_q <= 9'd2;
        then_q  <= is_pull ? Keep : Address;
        state_q <= count_good ? Get : Answer;
        if (count_good) count_q <= word_q[30:24];
      end

      Keep: begin
        address_q <= word_q;
        state_q   <= Kept;
      end
      Kept: begin
        wait_q <= wait_q + 2'd1;
        at_q   <= 9'd2;
        left_q <= 3'd4;
        then_q <= Address;
        if (wait_q == 2'd3) begin
          keep_valid_o <= !pull_before_i && !pull_after_i;
          state_q <= Get;
        end
      end
      Address: begin
        address_q <= word_q;
        if (is_write || is_push) count_q <= 7'((frame_bytes_i - 9'd10) >> 2);
        if (is_read) state_q <= Answer;
        else state_q <= is_pull ? Locate : Next;
      end
      Locate: begin
        wait_q <= wait_q + 2'd1;
        if (wait_q == 2'd3) begin
          if (pull_before_i || pull_after_i) count_q <= '0;
          state_q <= Answer;
        end
      end

      Next: begin
        left_q  <= 3'd4;
        then_q  <= Store;
        state_q <= count_q == 7'd0 ? Answer : Get;
      end
      Store:
      if (write_ready_i || is_push) begin
        if (is_write && write_status_i != 2'd0 && status_q != 2'd1) status_q <= write_status_i;
        first_q <= 1'b0;
        address_q <= address_q + 32'd1;
        count_q <= count_q - 7'd1;
        state_q <= Next;
      end

      Answer: begin
        source_q <= '0;
        source_q.header <= 1'b1;
        more_q <= !bad_q;
        if (bad_q) then_q <= Done;
        else then_q <= is_read ? Fetch : Body;
        state_q <= Load;
      end
      Body: begin
        source_q <= '0;
        source_q.status <= is_write;
        source_q.next <= is_push;
        // A position that cannot be given: the nearest one, and no words.
        source_q.first <= is_pull && pull_before_i;
        source_q.last <= is_pull && pull_after_i;
        source_q.position <= is_pull && !pull_before_i && !pull_after_i;
        more_q <= !is_write;
        if (is_write) then_q <= Done;
        else then_q <= is_push ? Room : Until;
        state_q <= Load;
      end
      Room: begin
        source_q <= '0;
        source_q.room <= 1'b1;
        more_q <= 1'b0;
        then_q <= Done;
        state_q <= Load;
      end
      Until: begin
        source_q <= '0;
        source_q.last <= 1'b1;
        more_q <= 1'b0;
        then_q <= Fetch;
        state_q <= Load;
      end
      Fetch: begin
        source_q <= '0;
        source_q.read <= is_read;
        source_q.pull <= is_pull;
        more_q <= 1'b0;
        state_q <= count_q == 7'd0 ? Done : Load;
      end
      default: state_q <= Idle;
    endcase
    if (rst_i) state_q <= Idle;
  end
endmodule
