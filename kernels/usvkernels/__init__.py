"""Pure JAX kernels of usvjax: arrays in, arrays out; lanes on the last axis."""
