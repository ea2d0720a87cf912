# SPDX-License-Identifier: Apache-2.0
from cinch.exact._exact import *
