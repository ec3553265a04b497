// The arithmetic that fingers share with the kernels (shaders/shared/exact_math.h). Decisions are made in single
// precision, and no compiler fuses a product with a sum: the engine is built with -ffp-contract=off.
#pragma once

#include "shaders/shared/exact_math.h"

namespace palpa::touch {

using shader::Float2;
using shader::Float3;
using shader::less;
using shader::plus;
using shader::product;

}  // namespace palpa::touch
