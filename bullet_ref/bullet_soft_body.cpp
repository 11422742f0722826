#include <BulletSoftBody/btSoftBody.h>

#include "core/model/solver.hpp"
