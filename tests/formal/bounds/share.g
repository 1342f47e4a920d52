# SPDX-License-Identifier: Apache-2.0
# Shader::share and Shader::interpolated: rho is the share over step, step = 2^x. The sum rho + 1/2 is exact in double, but above
# 2^w - 1/2, where it does not change the result.
code = fixed<0,dn>(rho + 1b-1);
q = weight / total;
exact_part = code * q * 4096;
part = fixed<0,dn>(exact_part + 1b-1);
y = light * part * step / 4096;
value = fixed<0,dn>(y + 1b-1);
due = light * step * rho * q;
limit = $(bound);
{ rho in [$(2^(w - 1) - 1/4), $(2^w)] /\ @FIX(weight, 0) /\ weight in [1, 4096] /\ @FIX(total, 0) /\ total in [1, 32768] /\ q in [0, 1] /\
  @FIX(light, 0) /\ light in [0, 1b96] /\ step in [1b-150, $(2^(8 - w))]
  -> value - due - limit <= 0 /\ value - due + limit >= 0 }
value - due - limit -> (value - y - 1b-1) + light * step * (part - exact_part - 1b-1) / 4096 + light * step * q * (code - rho - rho / $(2^w - 1)) { total <> 0 };
value - due + limit -> (value - y + 1b-1) + light * step * (part - exact_part + 1b-1) / 4096 + light * step * q * (code - rho + rho / $(2^w - 1)) { total <> 0 };
value - y -> (value - (y + 1b-1)) + 1b-1;
part - exact_part -> (part - (exact_part + 1b-1)) + 1b-1 { total <> 0 };
code - rho -> (code - (rho + 1b-1)) + 1b-1;
