// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report_page.hpp"

namespace posemix::internal {

ReportPage report_page() { return {}; }

}  // namespace posemix::internal
