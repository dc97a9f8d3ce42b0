!> What a scene is made of, in numbers: the effects whose loops run, and where their coefficients
!> and states stand. Runs of one scene differ only in the coefficients' values.
module rwmf_model_scene
   implicit none
   private

   public :: scene_t, term_t, add_term, is_same_scene
   public :: force_parts_t, force_parts_of
   public :: frame_term, linear_cable_term, straight_cable_term, first_wall
   public :: elsewhere, under_corner, through_link, in_cable, on_weight

   integer, parameter :: frame_term = -1
   integer, parameter :: linear_cable_term = -2
   integer, parameter :: straight_cable_term = -3
   integer, parameter :: elsewhere = 0
   !! a loop acts in more than one way, as floors, leaning columns and hinges do
   integer, parameter :: under_corner = 1
   !! along the chord of the corner that lifts
   integer, parameter :: through_link = 2
   integer, parameter :: in_cable = 3
   integer, parameter :: on_weight = 4
   integer, parameter :: first_wall = 2
   !! column of the first coefficient of the wall; column 1 is 1, and 0 while the wall is held

   !> A loop over lanes that adds to the equation of motion.
   type :: term_t
      integer :: effect = 0
      !! its number (`rwmf_model_effects_numbers`), or one of the `_term` numbers
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
      integer :: acts = elsewhere
      !! how its force reaches the wall
   end type term_t

   !> The loops of a scene in their order.
   type :: scene_t
      logical :: has_wall = .false.
      integer :: n = 2
      !! number of states
      integer :: n_coef = 1
      !! number of coefficients
      type(term_t), allocatable :: terms(:)
      integer :: bent = 0
      !! place of the term of a wall that bends: its loop changes the kinematics before all others,
      !! and its states follow theta'' after them; 0 for none
   end type scene_t

   !> The loops of a scene by the way in which their forces reach the wall, each with the columns of
   !> the whole scene.
   type :: force_parts_t
      logical :: is_complete = .false.
      !! nothing else exerts a force on the wall or on the ground
      logical :: has_shear_key = .false.
      !! which bears the horizontal force on the base, in the place of friction
      type(scene_t) :: through_link
      type(scene_t) :: under_corner
      !! along the chord of the corner that lifts
      type(scene_t) :: in_cable
   end type force_parts_t

contains

   !> Have two scenes the same loops with the same coefficients and states?
   pure logical function is_same_scene(one, other) result(is_same)
      type(scene_t), intent(in) :: one
      type(scene_t), intent(in) :: other

      is_same = (one%has_wall .eqv. other%has_wall) .and. one%n == other%n &
         .and. one%n_coef == other%n_coef .and. size(one%terms) == size(other%terms)
      if (.not. is_same) return
      is_same = all(one%terms%effect == other%terms%effect .and. one%terms%n == other%terms%n &
         .and. one%terms%law == other%terms%law .and. one%terms%coef == other%terms%coef &
         .and. one%terms%state == other%terms%state)
   end function is_same_scene

   !> Sort the loops of a scene by the way in which they act.
   pure type(force_parts_t) function force_parts_of(scene) result(parts)
      type(scene_t), intent(in) :: scene
      !! on corners or without wall

      parts%is_complete = all(scene%terms%acts /= elsewhere)
      parts%through_link = part_of(scene, through_link)
      parts%under_corner = part_of(scene, under_corner)
      parts%in_cable = part_of(scene, in_cable)
   end function force_parts_of

   !> The loops of a scene that act in one way.
   pure type(scene_t) function part_of(scene, acts) result(part)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: acts

      part = scene_t(scene%has_wall, scene%n, scene%n_coef, pack(scene%terms, scene%terms%acts &
         == acts))
   end function part_of

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
