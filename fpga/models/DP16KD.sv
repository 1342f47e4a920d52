// SPDX-License-Identifier: Apache-2.0
// Block RAM of the ECP5 (sysMEM EBR, 18,432 bits) as synthesis instantiates it: two ports of 1, 2, 4, 9 or 18 bits, or,
// with DATA_WIDTH_A = 36, a write port A of 36 bits (data in DIB, DIA) and a read port B, whose 36 bits come out of
// DOB, DOA.
//
// Address bits 13..5 name a word of 36 bits, the lower ones a part of it: 4 one of two 18-bit halves, 3 a byte of 9
// bits, 2..0 bits of its lower 8. A port of 18 or 36 bits has its byte enables in address bits 1..0 or 3..0.
// INITVAL_00 to _3F: sixteen 18-bit words each, 20 bits apart. A cycle counts for a port when its clock enable is 1 and
// its chip selects equal CSDECODE. In a cycle that writes, the port's output holds (NORMAL), shows the new word
// (WRITETHROUGH) or the old one (READBEFOREWRITE). RST clears the output alone, and with RESETMODE "SYNC" keeps the
// port from writing. REGMODE "OUTREG" puts a register with its own enable OCE behind the output.
//
// Collision: what is read of bits that the other port is set to write is undefined on the part when both clocks come
// together; here such bits are read inverted, so that whoever uses them fails. Two writes of one bit at once are
// undefined too.
//
// Behaviour: Lattice FPGA-TN-02204 (ECP5 memory usage guide); which of its forms occur: Yosys, techlibs/ecp5.
module DP16KD #(
    parameter DATA_WIDTH_A = 18,
    parameter DATA_WIDTH_B = 18,
    parameter [127:0] REGMODE_A = "NOREG",
    parameter [127:0] REGMODE_B = "NOREG",
    parameter [127:0] RESETMODE = "SYNC",
    parameter [127:0] ASYNC_RESET_RELEASE = "SYNC",
    parameter [127:0] CSDECODE_A = "0b000",
    parameter [127:0] CSDECODE_B = "0b000",
    parameter [127:0] WRITEMODE_A = "NORMAL",
    parameter [127:0] WRITEMODE_B = "NORMAL",
    parameter [127:0] CLKAMUX = "CLKA",
    parameter [127:0] CLKBMUX = "CLKB",
    parameter [127:0] GSR = "ENABLED",
    parameter [319:0] INITVAL_00 = 320'd0,
    parameter [319:0] INITVAL_01 = 320'd0,
    parameter [319:0] INITVAL_02 = 320'd0,
    parameter [319:0] INITVAL_03 = 320'd0,
    parameter [319:0] INITVAL_04 = 320'd0,
    parameter [319:0] INITVAL_05 = 320'd0,
    parameter [319:0] INITVAL_06 = 320'd0,
    parameter [319:0] INITVAL_07 = 320'd0,
    parameter [319:0] INITVAL_08 = 320'd0,
    parameter [319:0] INITVAL_09 = 320'd0,
    parameter [319:0] INITVAL_0A = 320'd0,
    parameter [319:0] INITVAL_0B = 320'd0,
    parameter [319:0] INITVAL_0C = 320'd0,
    parameter [319:0] INITVAL_0D = 320'd0,
    parameter [319:0] INITVAL_0E = 320'd0,
    parameter [319:0] INITVAL_0F = 320'd0,
    parameter [319:0] INITVAL_10 = 320'd0,
    parameter [319:0] INITVAL_11 = 320'd0,
    parameter [319:0] INITVAL_12 = 320'd0,
    parameter [319:0] INITVAL_13 = 320'd0,
    parameter [319:0] INITVAL_14 = 320'd0,
    parameter [319:0] INITVAL_15 = 320'd0,
    parameter [319:0] INITVAL_16 = 320'd0,
    parameter [319:0] INITVAL_17 = 320'd0,
    parameter [319:0] INITVAL_18 = 320'd0,
    parameter [319:0] INITVAL_19 = 320'd0,
    parameter [319:0] INITVAL_1A = 320'd0,
    parameter [319:0] INITVAL_1B = 320'd0,
    parameter [319:0] INITVAL_1C = 320'd0,
    parameter [319:0] INITVAL_1D = 320'd0,
    parameter [319:0] INITVAL_1E = 320'd0,
    parameter [319:0] INITVAL_1F = 320'd0,
    parameter [319:0] INITVAL_20 = 320'd0,
    parameter [319:0] INITVAL_21 = 320'd0,
    parameter [319:0] INITVAL_22 = 320'd0,
    parameter [319:0] INITVAL_23 = 320'd0,
    parameter [319:0] INITVAL_24 = 320'd0,
    parameter [319:0] INITVAL_25 = 320'd0,
    parameter [319:0] INITVAL_26 = 320'd0,
    parameter [319:0] INITVAL_27 = 320'd0,
    parameter [319:0] INITVAL_28 = 320'd0,
    parameter [319:0] INITVAL_29 = 320'd0,
    parameter [319:0] INITVAL_2A = 320'd0,
    parameter [319:0] INITVAL_2B = 320'd0,
    parameter [319:0] INITVAL_2C = 320'd0,
    parameter [319:0] INITVAL_2D = 320'd0,
    parameter [319:0] INITVAL_2E = 320'd0,
    parameter [319:0] INITVAL_2F = 320'd0,
    parameter [319:0] INITVAL_30 = 320'd0,
    parameter [319:0] INITVAL_31 = 320'd0,
    parameter [319:0] INITVAL_32 = 320'd0,
    parameter [319:0] INITVAL_33 = 320'd0,
    parameter [319:0] INITVAL_34 = 320'd0,
    parameter [319:0] INITVAL_35 = 320'd0,
    parameter [319:0] INITVAL_36 = 320'd0,
    parameter [319:0] INITVAL_37 = 320'd0,
    parameter [319:0] INITVAL_38 = 320'd0,
    parameter [319:0] INITVAL_39 = 320'd0,
    parameter [319:0] INITVAL_3A = 320'd0,
    parameter [319:0] INITVAL_3B = 320'd0,
    parameter [319:0] INITVAL_3C = 320'd0,
    parameter [319:0] INITVAL_3D = 320'd0,
    parameter [319:0] INITVAL_3E = 320'd0,
    parameter [319:0] INITVAL_3F = 320'd0
) (
    input logic DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3,
        DIA2, DIA1, DIA0,
    input logic ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0,
    input logic CEA, OCEA, CLKA, WEA, RSTA, CSA2, CSA1, CSA0,
    output logic DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3,
        DOA2, DOA1, DOA0,
    input logic DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3,
        DIB2, DIB1, DIB0,
    input logic ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0,
    input logic CEB, OCEB, CLKB, WEB, RSTB, CSB2, CSB1, CSB0,
    output logic DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3,
        DOB2, DOB1, DOB0
);
  if (!(DATA_WIDTH_A inside {1, 2, 4, 9, 18, 36}) || !(DATA_WIDTH_B inside {1, 2, 4, 9, 18, 36}) ||
      (DATA_WIDTH_B == 36 && DATA_WIDTH_A != 36)) begin : gen_bad_width
    dp16kd_widths_are_1_2_4_9_18_or_with_a_36 bad_width ();
  end

  localparam [20479:0] Initial = {
    INITVAL_3F, INITVAL_3E, INITVAL_3D, INITVAL_3C, INITVAL_3B, INITVAL_3A, INITVAL_39, INITVAL_38, INITVAL_37,
    INITVAL_36, INITVAL_35, INITVAL_34, INITVAL_33, INITVAL_32, INITVAL_31, INITVAL_30, INITVAL_2F, INITVAL_2E,
    INITVAL_2D, INITVAL_2C, INITVAL_2B, INITVAL_2A, INITVAL_29, INITVAL_28, INITVAL_27, INITVAL_26, INITVAL_25,
    INITVAL_24, INITVAL_23, INITVAL_22, INITVAL_21, INITVAL_20, INITVAL_1F, INITVAL_1E, INITVAL_1D, INITVAL_1C,
    INITVAL_1B, INITVAL_1A, INITVAL_19, INITVAL_18, INITVAL_17, INITVAL_16, INITVAL_15, INITVAL_14, INITVAL_13,
    INITVAL_12, INITVAL_11, INITVAL_10, INITVAL_0F, INITVAL_0E, INITVAL_0D, INITVAL_0C, INITVAL_0B, INITVAL_0A,
    INITVAL_09, INITVAL_08, INITVAL_07, INITVAL_06, INITVAL_05, INITVAL_04, INITVAL_03, INITVAL_02, INITVAL_01,
    INITVAL_00
  };
  localparam bit Wide = DATA_WIDTH_A == 36;  // A writes 36 bits, B reads

  // Both ports, A first.
  logic rst[0:1], enable[0:1], output_enable[0:1], write[0:1];
  logic [2:0] select[0:1];
  logic [13:0] address[0:1];
  logic [35:0] data_in[0:1], data_out[0:1];

  assign rst[0] = RSTA;
  assign enable[0] = CEA;
  assign output_enable[0] = OCEA;
  assign write[0] = WEA;
  assign select[0] = {CSA2, CSA1, CSA0};
  assign address[0] = {
    ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0
  };

  assign rst[1] = RSTB;
  assign enable[1] = CEB;
  assign output_enable[1] = OCEB;
  assign write[1] = WEB;
  assign select[1] = {CSB2, CSB1, CSB0};
  assign address[1] = {
    ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0
  };
  wire [17:0] data_b = {
    DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2, DIB1, DIB0
  };
  assign data_in[0] = {
    data_b,
    DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2, DIA1, DIA0
  };
  assign data_in[1] = {18'd0, data_b};
  assign {
    DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2, DOB1,
    DOB0
  } = DATA_WIDTH_B == 36 ? data_out[1][35:18] : data_out[1][17:0];
  assign {
    DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2, DOA1,
    DOA0
  } = Wide ? data_out[1][17:0] : data_out[0][17:0];

  /* verilator lint_off MULTIDRIVEN */  // two ports with a clock each
  logic [35:0] memory[0:511];
  /* verilator lint_on MULTIDRIVEN */
  initial for (int unsigned w = 0; w < 1024; w++) memory[w/2][18*(w%2)+:18] = Initial[20*w+:18];

  // Bits of its word that a port writes in this cycle, and their values.
  logic [35:0] mask[0:1], placed[0:1];

  for (genvar p = 0; p < 2; p++) begin : gen_port
    localparam int unsigned Width = p == 0 ? DATA_WIDTH_A : DATA_WIDTH_B;
    localparam bit Reads = !(Wide && p == 0);
    localparam bit Writes = !(Wide && p == 1);
    localparam [127:0] Decode = p == 0 ? CSDECODE_A : CSDECODE_B;
    localparam [127:0] WriteMode = p == 0 ? WRITEMODE_A : WRITEMODE_B;
    localparam bit Register = (p == 0 ? REGMODE_A : REGMODE_B) == "OUTREG";

    logic clk, active, writes;
    logic [8:0] word;
    logic [5:0] shift;
    logic [35:0] stored, output_d, output_q;

    if (p == 0) assign clk = CLKAMUX == "INV" ? !CLKA : CLKA;
    else assign clk = CLKBMUX == "INV" ? !CLKB : CLKB;
    assign active = enable[p] && select[p] == {Decode[16], Decode[8], Decode[0]};
    assign writes = Writes && active && write[p] && !(RESETMODE == "SYNC" && rst[p]);
    assign word = address[p][13:5];

    always_comb begin
      shift = 6'd9 * 6'(address[p][4:3]);
      if (Width < 9) shift = shift + (6'(address[p][2:0]) & ~6'(Width - 1));
      if (Width == 18) shift = 6'd18 * 6'(address[p][4]);
      if (Width == 36) shift = 6'd0;
      mask[p] = (36'd1 << Width) - 36'd1;
      if (Width == 36) mask[p] = {{9{address[p][3]}}, {9{address[p][2]}}, {9{address[p][1]}}, {9{address[p][0]}}};
      if (Width == 18) mask[p] = 36'({{9{address[p][1]}}, {9{address[p][0]}}});
      mask[p] = writes ? mask[p] << shift : '0;
      placed[p] = data_in[p] << shift;
    end

    always_comb begin
      stored = memory[word] ^ (address[1-p][13:5] == word ? mask[1-p] : '0);
      if (writes && WriteMode == "WRITETHROUGH") stored = (stored & ~mask[p]) | (placed[p] & mask[p]);
      output_d = (stored >> shift) & ((Width == 36 ? '0 : 36'd1 << Width) - 36'd1);
    end

    // Part by part, so that two ports can write different parts of one word in one cycle.
    always_ff @(posedge clk) begin
      if (Width >= 18) begin
        for (int unsigned k = 0; k < 4; k++) if (mask[p][9*k]) memory[word][9*k+:9] <= placed[p][9*k+:9];
      end else if (writes) memory[word][shift+:Width<18?Width : 1] <= data_in[p][0+:Width<18?Width : 1];
    end

    if (Reads) begin : gen_read
      logic update;
      assign update = active && !(writes && WriteMode == "NORMAL");
      if (RESETMODE == "ASYNC") begin : gen_async
        always_ff @(posedge clk or posedge rst[p])
          if (rst[p]) output_q <= '0;
          else if (update) output_q <= output_d;
      end else begin : gen_sync
        always_ff @(posedge clk)
          if (rst[p]) output_q <= '0;
          else if (update) output_q <= output_d;
      end
      if (!Register) begin : gen_out
        assign data_out[p] = output_q;
      end else if (RESETMODE == "ASYNC") begin : gen_register_async
        always_ff @(posedge clk or posedge rst[p])
          if (rst[p]) data_out[p] <= '0;
          else if (output_enable[p]) data_out[p] <= output_q;
      end else begin : gen_register
        always_ff @(posedge clk)
          if (rst[p]) data_out[p] <= '0;
          else if (output_enable[p]) data_out[p] <= output_q;
      end
    end else begin : gen_no_read
      assign data_out[p] = '0;
    end
  end
endmodule
