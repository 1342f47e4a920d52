// SPDX-License-Identifier: Apache-2.0
// Generated: the clocks of ulx3s-85f as they were asked for, and the dividers of its PLL that make them.
package board_pkg;
  /* verilator lint_off UNUSEDPARAM */  // a top reads those that concern it
  localparam int CoreKHz = 50000;
  localparam int ClocksPerBit = 25;  // core clocks a UART bit: 2000000 baud
  localparam int PllReference = 1;
  localparam int PllFeedback = 2;
  localparam int PllOutput = 12;
  localparam int VcoKHz = 600000;
  localparam int SdramKHz = 0;  // of the SDRAM's controller; 0: there is none
  /* verilator lint_on UNUSEDPARAM */
endpackage
