// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

/** How much larger than usual the page's text is, as on a large screen; what is drawn grows with it. */
export const enlarged = (): number => parseFloat(getComputedStyle(document.documentElement).fontSize) / 16 || 1;
