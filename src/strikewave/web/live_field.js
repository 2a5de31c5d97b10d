export default {
  template: `
    <div class="sw-field">
      <label :for="$attrs.id + '-typed'" :title="hint">{{ label }}</label>
      <input :id="$attrs.id + '-typed'" v-model="text" :aria-label="path" @keydown.enter="type" @blur="type" />
      <input v-if="high > low" type="range" :min="low" :max="high" :step="step" :value="at" :aria-label="path"
        :aria-valuetext="text" @input="move" @keydown.ctrl.z.prevent="$emit('back')" @keydown.meta.z.prevent="$emit('back')" />
    </div>`,
  props: { path: String, label: String, hint: String, typed: String, low: Number, high: Number,
    step: Number, value: Number },
  emits: ["move", "type", "back"],
  data() {
    return { text: this.typed, at: this.value, last: this.typed };
  },
  methods: {
    move(event) {
      this.at = event.target.valueAsNumber;
      this.$emit("move", this.at);
    },
    type() {
      if (this.text !== this.last) this.$emit("type", this.text);
    },
    show(text, at) {
      this.text = this.last = text;
      if (at !== null) this.at = at;
    },
  },
};
