export default {
  template: `<div v-html="shown"></div>`,
  props: { content: String },
  data() {
    return { shown: this.content };
  },
  methods: {
    show(content) {
      this.shown = content;
    },
  },
};
