// SPDX-License-Identifier: MIT
// A scene that is changed in any order: against one that is computed anew from the roots.
#include "scene_model.hpp"

CROFTON_FUZZ(in) {
    crofton::fuzz::LivingScene living(in);
    for (int step = 0; step < 60 && in.more(); ++step) {
        living.change(in);
        if (in.below(4) == 0) living.settle();
    }
    living.settle();
}
