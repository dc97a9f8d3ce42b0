!> What a scene is made of, in numbers: the effects whose loops run, and where their coefficients
!> and states stand. Runs of one scene differ only in the coefficients' values.
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
      integer :: n_coef = 0
      !! number of its coefficients
      integer :: n_states = 0
      !! number of states of its own, or of another's that it reads
      integer :: coef = 1
      !! column of the first of these coefficients
      integer :: state = 1
      !! number of the first of these states
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
   pure subroutine add_term(scene, term)
      type(scene_t), intent(inout) :: scene
      type(term_t), intent(in) :: term
      !! without the places of its coefficients and states

      scene%terms = [scene%terms, term]
      associate (added => scene%terms(size(scene%terms)))
         added%coef = scene%n_coef + 1
         added%state = scene%n + 1
         scene%n_coef = scene%n_coef + added%n_coef
         scene%n = scene%n + added%n_states
      end associate
   end subroutine add_term

end module rwmf_model_scene
