// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/executor.hpp"

namespace plvo {

// Outside of the templates, so that stack analysis finds the indirect call in this one place.
void Executor::start(Task here, Task beside) const { run(runner, here, beside); }

}  // namespace plvo
