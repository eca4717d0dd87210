#include "ros2_stubs.hpp"
