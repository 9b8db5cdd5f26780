// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/executor.hpp"

namespace plvo {

// Apart from the templates: whoever bounds the stack has this call alone to know.
void Executor::start(Task here, Task beside) const { run(runner, here, beside); }

}  // namespace plvo
