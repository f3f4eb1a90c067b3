"""How near the kernels are to what the machine can do: operations counted, times measured, bounds beside them."""
