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
    Get,        // left_q bytes into word_q, then then_q
    GetByte,
    Settle,     // 4 cycles, then then_q
    Send,       // left_q bytes of word_q, then then_q
    Command,
    Address,
    Check,
    Count,      // READ, PULL
    Keep,       // PULL
    Kept,
    Position,
    Next,       // WRITE, PUSH: word by word
    Store,
    Answer,     // its id and command
    Status,     // WRITE
    Taken,      // PUSH
    Room,
    From,       // PULL
    Until,
    Enough,
    Fetch,      // READ, PULL: word by word
    Load,
    Done
  } state_t;

  state_t state_q, then_q;
  logic [7:0] id_q, command_q;
  logic [31:0] word_q, address_q;
  logic [8:0] at_q;
  logic [6:0] count_q;  // words that follow
  logic [2:0] left_q;
  logic [1:0] settle_q, status_q;
  logic bad_q, final_q, first_q, at_next_q;
  logic is_read, is_write, is_push, is_pull, body_good, count_good;
  logic [31:0] pull_left;

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
  assign pull_left = pull_end_i - address_q;

  assign frame_done_o = state_q == Done;
  assign frame_bad_o = state_q == Done && bad_q;
  assign read_address_o = at_q;
  assign address_o = address_q;
  assign write_word_o = word_q;
  assign first_o = first_q;
  assign read_valid_o = state_q == Load && is_read;
  assign write_last_o = count_q == 7'd1;
  assign push_word_o = word_q;
  assign write_valid_o = state_q == Store && is_write;
  assign push_valid_o = state_q == Store && is_push && at_next_q;
  assign answer_valid_o = state_q == Send;
  assign answer_o = word_q[7:0];
  assign answer_last_o = final_q && left_q == 3'd1;

  always_ff @(posedge clk_i) begin
    keep_valid_o <= 1'b0;
    // The position is older than the word that is in hand.
    at_next_q <= address_q == push_position_i;
    unique case (state_q)
      Idle: begin
        at_q <= '0;
        left_q <= 3'd2;
        then_q <= Command;
        status_q <= 2'd0;
        final_q <= 1'b0;
        first_q <= 1'b1;
        bad_q <= frame_bad_i;
        if (frame_valid_i) state_q <= frame_bad_i ? Answer : Get;
      end

      Get: begin
        settle_q <= settle_q + 2'd1;
        if (settle_q == 2'd2) state_q <= GetByte;
      end
      GetByte: begin
        settle_q <= '0;
        word_q <= {read_data_i, word_q[31:8]};
        at_q <= at_q + 9'd1;
        left_q <= left_q - 3'd1;
        state_q <= left_q == 3'd1 ? then_q : Get;
      end
      Settle: begin
        settle_q <= settle_q + 2'd1;
        if (settle_q == 2'd3) state_q <= then_q;
      end
      Send:
      if (answer_ready_i) begin
        word_q <= {8'd0, word_q[31:8]};
        left_q <= left_q - 3'd1;
        if (left_q == 3'd1) state_q <= then_q;
      end

      Command: begin
        {command_q, id_q} <= word_q[31:16];
        left_q <= 3'd4;
        then_q <= Address;
        state_q <= Get;
      end
      Address: begin
        address_q <= word_q;
        count_q <= 7'((frame_bytes_i - 9'd10) >> 2);
        left_q <= 3'd1;
        then_q <= Count;
        state_q <= Check;
      end
      Check: begin
        bad_q <= !body_good;
        if (!body_good) state_q <= Answer;
        else state_q <= is_read || is_pull ? Get : Next;
      end
      Count: begin
        count_q <= word_q[30:24];
        bad_q   <= !count_good;
        left_q  <= 3'd4;
        then_q  <= Keep;
        state_q <= is_pull && count_good ? Get : Answer;
      end

      Keep: begin
        word_q <= address_q;
        address_q <= word_q;
        then_q <= Kept;
        state_q <= Settle;
      end
      Kept: begin
        keep_valid_o <= !pull_before_i && !pull_after_i;
        then_q <= Position;
        state_q <= Settle;
      end
      Position: begin
        address_q <= word_q;
        then_q <= Answer;
        state_q <= Settle;
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
        word_q[15:0] <= bad_q ? 16'hFF00 : {8'h80 | command_q, id_q};
        left_q <= 3'd2;
        final_q <= bad_q;
        if (bad_q) then_q <= Done;
        else if (is_write) then_q <= Status;
        else if (is_push) then_q <= Taken;
        else then_q <= is_pull ? From : Fetch;
        // A position that cannot be given: the nearest one, and no words.
        if (is_pull && !bad_q) begin
          if (pull_before_i) address_q <= pull_first_i;
          else if (pull_after_i) address_q <= pull_end_i;
          if (pull_before_i || pull_after_i) count_q <= '0;
        end
        state_q <= Send;
      end
      Status: begin
        word_q  <= 32'(status_q);
        left_q  <= 3'd4;
        final_q <= 1'b1;
        then_q  <= Done;
        state_q <= Send;
      end
      Taken: begin
        word_q  <= push_position_i;
        left_q  <= 3'd4;
        then_q  <= Room;
        state_q <= Send;
      end
      Room: begin
        word_q  <= 32'(push_room_i);
        left_q  <= 3'd4;
        final_q <= 1'b1;
        then_q  <= Done;
        state_q <= Send;
      end
      From: begin
        word_q  <= address_q;
        left_q  <= 3'd4;
        then_q  <= Until;
        state_q <= Send;
      end
      Until: begin
        word_q <= pull_end_i;
        if (pull_left < 32'(count_q)) count_q <= pull_left[6:0];
        state_q <= Enough;
      end
      Enough: begin
        left_q  <= 3'd4;
        final_q <= count_q == 7'd0;
        then_q  <= count_q == 7'd0 ? Done : Fetch;
        state_q <= Send;
      end
      Fetch: begin
        then_q  <= Load;
        state_q <= Settle;
      end
      Load: begin
        word_q <= is_pull ? pull_word_i : read_word_i;
        first_q <= 1'b0;
        address_q <= address_q + 32'd1;
        count_q <= count_q - 7'd1;
        left_q <= 3'd4;
        final_q <= count_q == 7'd1;
        then_q <= count_q == 7'd1 ? Done : Fetch;
        state_q <= Send;
      end
      default: state_q <= Idle;
    endcase
    if (rst_i) begin
      state_q  <= Idle;
      settle_q <= '0;
    end
  end
endmodule
