// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cinch {

/// What bodies do to each other. It looks at them before every frame, and tells an effect on each what to do until the
/// next.
class Coupling {
public:
    virtual ~Coupling() = default;
    /// For the bodies as they are. The same for every thread count and history.
    virtual void find() = 0;
};

} // namespace cinch
