#pragma once
#include <cstdlib>
namespace plvo { inline int toggles(){ static const int t = std::getenv("PLVO_T") ? std::atoi(std::getenv("PLVO_T")) : 0; return t; } }
