!> What a scene is made of, in numbers: the effects whose loops run, and where their coefficients and
!> states stand. Runs of one scene differ only in the numbers.
module rwmf_model_scene
   implicit none
   private

   public :: scene_t, term_t, add_term
   public :: frame_term, linear_cable_term, straight_cable_term, first_wall

   integer, parameter :: frame_term = -1
   integer, parameter :: linear_cable_term = -2
   integer, parameter :: straight_cable_term = -3
   integer, parameter :: first_wall = 2
   !! column of the first coefficient of the wall; column 1 is 1, and 0 while the wall is held

   !> A loop over lanes that adds to the equation of motion.
   type :: term_t
      integer :: effect = 0
      !! its number in the list of effects, or one of the `_term` numbers
      integer :: n = 0
      !! how many parts it has (floors)
      integer :: law = 0
      !! which law it follows
      integer :: coef = 1
      !! column of its first coefficient
      integer :: state = 1
      !! number of the first state that it reads
   end type term_t

   !> The loops of a scene in their order.
   type :: scene_t
      logical :: has_wall = .false.
      integer :: n = 2
      !! number of states
      integer :: n_coef = 1
      !! number of coefficients
      type(term_t), allocatable :: terms(:)
   end type scene_t

contains

   !> Add a loop with its coefficients and states behind those that are there.
   pure subroutine add_term(scene, effect, n, law, n_coef, n_states, is_first, state)
      type(scene_t), intent(inout) :: scene
      integer, intent(in) :: effect
      integer, intent(in) :: n
      !! how many parts it has
      integer, intent(in) :: law
      !! which law it follows
      integer, intent(in) :: n_coef
      integer, intent(in) :: n_states
      logical, intent(in) :: is_first
      !! it runs before the others
      integer, intent(in), optional :: state
      !! number of the first state that it reads, where this is another effect's
      type(term_t) :: term

      term = term_t(effect, n, law, scene%n_coef + 1, scene%n + 1)
      if (present(state)) term%state = state
      if (is_first) then
         scene%terms = [term, scene%terms]
      else
         scene%terms = [scene%terms, term]
      end if
      scene%n_coef = scene%n_coef + n_coef
      scene%n = scene%n + n_states
   end subroutine add_term

end module rwmf_model_scene
