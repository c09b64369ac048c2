# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
