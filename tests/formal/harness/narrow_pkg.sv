// SPDX-License-Identifier: Apache-2.0
// Packets of the proofs: the fields that control reads, and one or two bits for all that it only carries.
package photonloom_pkg;
  localparam int unsigned LutRamWords = 64;
endpackage
