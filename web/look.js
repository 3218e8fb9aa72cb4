// Colours: Okabe and Ito's, which colour-blind people can tell apart, and what they stand for everywhere.

export const SECTIONS = ["#0072B2", "#56B4E9", "#009E73", "#7A6FAC"];
export const OBSTACLE = "#D55E00";
export const EXPECTED = "#B0418E";
export const GOAL = "#222222";
export const PATH = "#222222";
export const TRAIL = "#0072B2";
export const PLANNERS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C6D31"];
export const VERDICTS = { per_step: "per step", swept: "swept", executable: "executable" };
