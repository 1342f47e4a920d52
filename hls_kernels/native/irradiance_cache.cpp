// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/irradiance_cache/irradiance_cache.hpp"
#include "hls_kernels/native/shell.hpp"

namespace photonloom_hls {

std::unique_ptr<Shell> make_shell(uint64_t seed, const FarEnd& far_end) {
  return std::make_unique<
      StreamShell<IrradianceCache<Native>, CacheLookup<Native>, CacheResult<Native>>>(seed,
                                                                                      far_end);
}

}  // namespace photonloom_hls

PHOTONLOOM_HLS_INTERFACE(IrradianceCache)
