// Stages of a command's work, in words for a person.

const kStages: Record<string, string> = {
  blend: "Reading the clips",
  base: "Preparing the picture",
  match: "Matching contrast",
  render: "Rendering",
  "ways/design/scene.toml": "Simulating",
  "measuring flow": "Measuring the flow",
};

export function stageWords(stage: string): string {
  const words = kStages[stage] ?? stage;
  return words.charAt(0).toUpperCase() + words.slice(1);
}
